//! Distributions against numbers of scipy, and of formulas.

use serde::Deserialize;
use sizes::{Distribution, Law, Part, Spec, Table, TableError};

#[derive(Deserialize)]
struct Data {
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    spec: String,
    shares: Vec<f64>,
    quantiles: Vec<f64>,
    /// Means of the diameter, its square and its cube.
    moments: [f64; 3],
    /// Share of the volume that diameters below the median have.
    volume_below_median: f64,
}

fn distribution(spec: &str) -> Distribution {
    spec.parse::<Spec>().expect("a good distribution").distribution(3)
}

fn assert_near(value: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((value / expected - 1.0).abs() < tolerance, "{what}: {value} for {expected}");
}

#[test]
fn quantiles_and_moments_are_those_of_scipy() {
    let data: Data = serde_json::from_str(include_str!("data/scipy.json")).expect("reference data");
    for Case { spec, shares, quantiles, moments, volume_below_median } in data.cases {
        let ours = distribution(&spec);
        for (share, quantile) in shares.iter().zip(&quantiles) {
            assert_near(ours.quantile(*share), *quantile, 1e-9, &spec);
            assert_near(ours.cdf(*quantile), *share, 1e-9, &spec);
        }
        for (power, moment) in (1..).zip(moments) {
            assert_near(ours.moment(power), moment, 1e-9, &spec);
        }
        assert_near(ours.share_below(ours.quantile(0.5), 3), volume_below_median, 1e-9, &spec);
    }
}

/// Numbers for a mean of 1: a lognormal distribution is one by volume too, with the logarithm's mean 3 sigma^2 higher.
#[test]
fn lognormal_by_volume_has_the_formula_s_median() {
    for (variation, median, cube) in [
        ("0.1", 1.025_187_812_11, 1.030_301),
        ("0.35", 1.334_952_688_08, 1.414_357_015_63),
        ("1.0", 5.656_854_249_49, 8.0),
    ] {
        let ours = distribution(&format!("lognormal(mean=1, cv={variation})"));
        assert_near(ours.share_below(median, 3), 0.5, 1e-10, variation);
        assert_near(ours.moment(3), cube, 1e-11, variation);
        assert_near(ours.variation(), variation.parse().expect("a number"), 1e-12, variation);
    }
}

#[test]
fn weights_by_volume_are_shares_of_volumes_or_areas() {
    let spec: Spec = "0.7*equal(1) + 0.3*equal(10), by=volume".parse().expect("a good distribution");
    for axes in [2, 3] {
        let ours = spec.distribution(axes);
        assert_near(ours.share_below(5.0, axes), 0.7, 1e-14, "share");
        assert_eq!([ours.quantile(0.5), ours.quantile(1.0)], [1.0, 10.0]);
    }
}

#[test]
fn tables_are_distributions() {
    let list = Table::list(&[3.0, 1.0, 2.0, 2.0]).expect("a good list");
    let of = |table: Table| {
        let part = Part::new(Law::Table(table), 0.0, f64::INFINITY).expect("all of it");
        Distribution::new(vec![(1.0, part)], None)
    };
    let ours = of(list);
    let drawn: Vec<f64> = (0..4).map(|place| ours.quantile((f64::from(place) + 0.5) / 4.0)).collect();
    assert_eq!(drawn, [1.0, 2.0, 2.0, 3.0], "as many quantiles as items are the list");
    assert_eq!([ours.cdf(0.9), ours.cdf(1.0), ours.cdf(2.5), ours.cdf(3.0)], [0.0, 0.25, 0.75, 1.0]);
    assert_near(ours.moment(3), (1.0 + 8.0 + 8.0 + 27.0) / 4.0, 1e-15, "mean cube");

    let function = Table::distribution_function(&[[10.0, 0.0], [20.0, 50.0], [20.0, 60.0], [40.0, 100.0]]);
    let ours = of(function.expect("a good table"));
    for (diameter, share) in
        [(5.0, 0.0), (15.0, 0.25), (19.999_999, 0.5), (20.0, 0.6), (30.0, 0.8), (40.0, 1.0)]
    {
        assert!((ours.cdf(diameter) - share).abs() < 1e-7, "{diameter}");
    }
    assert_eq!(ours.quantile(0.55), 20.0);
    assert_near(ours.mean(), 0.5 * 15.0 + 0.1 * 20.0 + 0.4 * 30.0, 1e-14, "mean");

    let bins = [[0.0, 10.0, 1.0], [10.0, 20.0, 1.0]];
    assert_near(of(Table::histogram(&bins, None).expect("good bins")).cdf(5.0), 0.25, 1e-14, "by number");
    for axes in [2, 3] {
        let by_volume = of(Table::histogram(&bins, Some(axes)).expect("good bins"));
        assert_near(by_volume.share_below(10.0, axes), 0.5, 1e-14, "by volume");
    }
}

#[test]
fn rows_that_are_no_table_are_named() {
    let bad = |diameter: f64| TableError::Diameter { row: 2, diameter };
    assert_eq!(Table::list(&[]), Err(TableError::Empty));
    assert_eq!(Table::list(&[1.0, 0.0]), Err(bad(0.0)));
    assert_eq!(Table::list(&[1.0, f64::INFINITY]), Err(bad(f64::INFINITY)));
    let histogram = |bins: &[[f64; 3]]| Table::histogram(bins, None);
    assert_eq!(histogram(&[[0.0, 1.0, 0.0]]), Err(TableError::NoWeight));
    assert_eq!(
        histogram(&[[0.0, 1.0, 1.0], [0.5, 2.0, 1.0]]),
        Err(TableError::Bin { row: 2, from: 0.5, to: 2.0 })
    );
    assert_eq!(histogram(&[[0.0, 1.0, -1.0]]), Err(TableError::Weight { row: 1, weight: -1.0 }));
    let function = Table::distribution_function;
    assert_eq!(function(&[[1.0, 0.5], [2.0, 1.0]]), Err(TableError::Begins { share: 0.5 }));
    assert_eq!(function(&[[1.0, 0.0], [2.0, 1.0], [3.0, 0.9]]), Err(TableError::Falls { row: 3 }));
    assert_eq!(function(&[[1.0, 0.0]]), Err(TableError::Empty));
}

#[test]
fn mistaken_words_are_told_with_a_remedy() {
    for (text, problem) in [
        ("", "is empty; write lognormal(mean=20, cv=0.35), for example"),
        ("lognomal(mean=1,cv=0.3)", "'lognomal' is unknown; did you mean 'lognormal'?"),
        (
            "beta(1,2)",
            "'beta' is unknown; there are equal, normal, lognormal, uniform, weibull, gamma, and sums of them",
        ),
        ("20", "'20' is a number alone; write equal(20)"),
        (
            "lognormal(20, 0.35)",
            "'lognormal(20, 0.35)' needs mean and cv, or mean and sd, or median and sigma, and may have from and to: \
             lognormal(mean=20, cv=0.35)",
        ),
        (
            "normal(mean=20)",
            "'normal(mean=20)' needs mean and sd, or mean and cv, and may have from and to: normal(mean=20, sd=5)",
        ),
        (
            "lognormal(mean=20,cv=0)",
            "cv=0 in 'lognormal(mean=20,cv=0)' is not positive; give a positive number; for grains of one size write equal(20)",
        ),
        ("equal(-3)", "d=-3 in 'equal(-3)' is not positive; give a positive number"),
        ("equal(nan)", "d=nan is not a finite number; write d=0.5, for example"),
        (
            "uniform(30, 10)",
            "'uniform(30, 10)': from 30 to 10 is not a range of diameters; write the smaller one first",
        ),
        (
            "normal(mean=20, sd=1, from=30)",
            "'normal(mean=20, sd=1, from=30)': almost nothing of it is left from 30 to inf (a share of 0.0e0); widen the cut-offs",
        ),
        ("equal(3), from=5, to=4", "'equal(3)' is cut off from 5 to 4; give a range"),
        ("equal(3), by=mass", "by=mass is unknown; write by=number or by=volume"),
        ("equal(3), under=5", "'under=5' is unknown; behind the sum may stand from=5, to=80, by=volume"),
        ("0.5*equal(3)+equal(4)", "'equal(4)' has no weight, others do; write 0.5*equal(4), for example"),
        ("-0.5*equal(3)", "the weight -0.5 is not positive and finite; leave out what has no share"),
        ("equal(3)*equal(4)", "'equal(3)*equal(4)' multiplies two distributions; add them with +"),
        ("equal(3)+", "nothing stands on one side of a '+'; write lognormal(mean=20, cv=0.35), for example"),
        ("equal(3", "a bracket is not closed; add ')'"),
        ("equal 3)", "a ')' closes nothing; take it out"),
    ] {
        let error = text.parse::<Spec>().expect_err(text);
        assert_eq!(error.to_string(), format!("diameters '{text}': {problem}"));
    }
}

#[test]
fn words_may_stand_with_blanks_and_in_any_order() {
    let plain = distribution("0.8*lognormal(mean=20,cv=0.3)+0.2*equal(60),from=10,to=70,by=volume");
    for text in [
        " lognormal( cv = 0.3 , mean = 20 ) * 0.8 + equal(d=60)*0.2 by=volume to=70 from=10",
        "0.4*2*LogNormal(mean=2e1,cv=0.3,from=10,to=70) + 0.2*equal(60), by = volume",
    ] {
        let other = distribution(text);
        for share in [0.0, 0.01, 0.5, 0.99, 1.0] {
            assert_eq!(other.quantile(share), plain.quantile(share), "{text}");
        }
    }
}
