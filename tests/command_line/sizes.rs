//! Grains of given sizes: distributions, lists, volumes, what is reached, what is refused.

use serde_json::Value;

use crate::workplace::{FAILED, USAGE, Workplace};

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("no number {key} in {value}"))
}

/// Numbers of a column of a table of cells.
fn column(workplace: &Workplace, arguments: &str, name: &str) -> Vec<f64> {
    workplace.run(&format!("{arguments} --no-mesh --cells-json cells.json"));
    let table = workplace.json("cells.json");
    table["cells"].as_array().unwrap().iter().map(|cell| number(cell, name)).collect()
}

#[test]
fn distribution_is_reached_by_cells_and_kept_by_relaxation() {
    let workplace = Workplace::new();
    for (options, count) in [
        ("", 60),
        ("--periodic x,y,z", 60),
        ("--periodic x,y,z --periodic-cut box", 60),
        ("--domain sphere --chord-error 0.02", 40),
        ("--dim 2", 80),
        ("--dim 2 --periodic x,y", 80),
        ("--dim 2 --domain disc", 50),
    ] {
        let said = workplace.run(&format!(
            "--seeds {count} --diameters lognormal(mean=3,cv=0.35) {options} -n 1 --json-summary s.json"
        ));
        assert!(
            said.contains("sizes       asked lognormal(mean=3,cv=0.35) (mean 3.0000, cv 0.3500; quantiles)"),
            "{said}"
        );
        let summary = workplace.json("s.json");
        assert_eq!(summary["grains"], count);
        let sizes = &summary["sizes"];
        assert!(number(sizes, "cdf_distance") <= 0.5 / f64::from(count) + 1e-12, "{options}: {sizes}");
        assert!(number(sizes, "largest_volume_error_of_cells") < 1e-10, "{options}: {sizes}");
        assert!(number(sizes, "largest_volume_error") < 1e-10, "{options}: {sizes}");
        assert_eq!(sizes["centroid_steps"], 10);
        let mean = number(&summary["equivalent_diameter"], "mean");
        assert!((mean / (3.0 * number(sizes, "scale")) - 1.0).abs() < 0.02, "{mean}: {sizes}");
    }
}

#[test]
fn as_many_grains_are_made_as_fill_the_domain() {
    let workplace = Workplace::new();
    for (options, axes) in [("--box 100 80 60", 3), ("--dim 2 --box 400 300", 2)] {
        for diameters in
            ["lognormal(mean=15,cv=0.35)", "0.8*lognormal(mean=10,cv=0.3)+0.2*equal(25),by=volume"]
        {
            workplace.run(&format!("{options} --diameters {diameters} -n 0 --relax 0 --json-summary s.json"));
            let summary = workplace.json("s.json");
            let scale = number(&summary["sizes"], "scale");
            let count = number(&summary, "grains");
            // One grain more or less.
            assert!(
                (scale - 1.0).abs() < 1.0 / (f64::from(axes) * count),
                "{diameters}: {scale} with {count}"
            );
        }
    }
    // Of what the distribution has in its tail, random draws have what chance gives.
    workplace.run("--box 9 9 9 --diameters uniform(1,2) --draw random -n 0 --relax 0 --json-summary s.json");
    let sizes = &workplace.json("s.json")["sizes"];
    assert!((0.9..1.1).contains(&number(sizes, "scale")), "{sizes}");
    let count = number(&workplace.json("s.json"), "grains");
    assert!(number(sizes, "cdf_distance") > 0.5 / count, "{sizes}");
}

#[test]
fn tables_of_diameters_are_distributions() {
    let workplace = Workplace::new();
    let listed = "diameter,name\n1,a\n2,b\n# a remark\n3,c\n\n2,d\n";
    let function = "diameter cdf\n1 0\n1 25\n2 25\n2 75\n3 75\n3 100\n";
    let volumes = "v;Volume\n0;1\n0;8\n0;8\n0;27\n";
    for file in [listed, function, volumes, "1\n2\n2\n3\n"] {
        workplace.put("d.csv", file);
        let mut found = column(&workplace, "--seeds 4 --diameters d.csv", "equivalent_diameter");
        found.sort_by(f64::total_cmp);
        for (diameter, expected) in found.iter().zip([1.0, 2.0, 2.0, 3.0]) {
            assert!((diameter / found[0] / expected - 1.0).abs() < 1e-9, "{file}: {found:?}");
        }
    }
    // Half of the volume is in grains of diameters 10 to 20.
    workplace.put("h.txt", "from to volume_fraction\n0 10 50\n10 20 50\n");
    let found = column(&workplace, "--seeds 200 --diameters h.txt", "volume");
    let most = found.iter().copied().fold(0.0, f64::max);
    let small: f64 = found.iter().filter(|volume| **volume < 0.13 * most).sum();
    assert!((small - 0.5).abs() < 0.05, "{small}");
}

#[test]
fn each_grain_has_the_volume_given_to_it() {
    let workplace = Workplace::new();
    workplace.put("v.csv", "id, volume\na, 1\nb, 2\nc, 3\nd, 2\n");
    let found = column(&workplace, "--volumes v.csv", "volume");
    for (volume, expected) in found.iter().zip([0.125, 0.25, 0.375, 0.25]) {
        assert!((volume / expected - 1.0).abs() < 1e-10, "{found:?}");
    }
    // Seeds of a file stay where they are, and their radii count no more.
    workplace.put("s.csv", "x,y,z,radius\n.2,.2,.2,.1\n.8,.3,.4,.3\n.5,.5,.8,.1\n.3,.8,.3,.1\n");
    let said = workplace.run("--seeds-file s.csv --volumes v.csv --no-mesh --cells-json c.json");
    assert!(said.contains("passed over radii or weights, as grains have other sizes, in s.csv"), "{said}");
    let cells = workplace.json("c.json")["cells"].clone();
    assert_eq!(cells[1]["seed"], serde_json::json!([0.8, 0.3, 0.4]));
    assert!((number(&cells[2], "volume") / 0.375 - 1.0).abs() < 1e-10);
    workplace.put("a.txt", "1\n3\n");
    let found = column(&workplace, "--volumes a.txt --dim 2 --box 2 2", "area");
    assert!((found[1] / 3.0 - 1.0).abs() < 1e-10, "{found:?}");
    // A table of cells gives its volumes back.
    workplace.run("--seeds 20 --no-mesh --cells-csv cells.csv");
    let given = column(&workplace, "--seeds 20", "volume");
    let found = column(&workplace, "--volumes cells.csv", "volume");
    for (volume, expected) in found.iter().zip(given) {
        assert!((volume / expected - 1.0).abs() < 1e-9, "{volume} for {expected}");
    }
}

#[test]
fn packed_grains_are_like_those_of_metals() {
    let workplace = Workplace::new();
    let cells = "--seeds 300 --periodic x,y,z --seeding packed";
    let faces = column(&workplace, cells, "nfaces");
    let mean = faces.iter().sum::<f64>() / 300.0;
    assert!((mean - 13.72).abs() < 0.25, "{mean} faces");
    let sphericity = column(&workplace, cells, "sphericity");
    let mean = sphericity.iter().sum::<f64>() / 300.0;
    assert!((mean - 0.855).abs() < 0.01, "sphericity {mean}");
}

#[test]
fn settings_of_a_file_repeat_its_sizes() {
    let workplace = Workplace::new();
    workplace.put("v.csv", "1\n2\n3\n4\n5\n");
    workplace.put("s.csv", "x,y,z\n.2,.2,.2\n.8,.3,.4\n.5,.5,.8\n");
    for options in [
        "--diameters 0.7*uniform(1,2)+0.3*equal(4),by=volume --box 9 9 9",
        "--diameters gamma(mean=1,cv=0.4) --seeds 12 --draw random --lloyd 2",
        "--volumes v.csv --seeding poisson-disc",
        "--seeding packed --seeds 9",
        "--seeds-file s.csv --diameters weibull(shape=3,scale=1)",
    ] {
        workplace.run(&format!("{options} -n 0 --relax 0 -o a.vtp"));
        workplace.run("--config a.vtp -o b.vtp");
        assert!(workplace.bytes("a.vtp") == workplace.bytes("b.vtp"), "{options}");
    }
    workplace.put("run.toml", "diameters = 'equal(2)'\nseeds = 5\nlloyd = 0\nlevels = 0\nrelax = 0\n");
    workplace.run("--config run.toml");
    workplace.run("--config run.toml --lattice sc 2");
}

#[test]
fn sizes_that_are_mistaken() {
    let workplace = Workplace::new();
    let value = |value: &str, message: &str| {
        format!("invalid value '{value}' for '--diameters <SPEC|FILE>': diameters '{value}': {message}")
    };
    for (spec, message) in [
        ("lognomal(mean=1,cv=0.3)", "'lognomal' is unknown; did you mean 'lognormal'?"),
        (
            "normal(20,5)",
            "'normal(20,5)' needs mean and sd, or mean and cv, and may have from and to: normal(mean=20, sd=5)",
        ),
        ("0.5*equal(3)+equal(4)", "'equal(4)' has no weight, others do; write 0.5*equal(4), for example"),
        (
            "equal(3),from=5",
            "'equal(3)': almost nothing of it is left from 5 to inf (a share of 0.0e0); widen the cut-offs",
        ),
    ] {
        workplace.refuses(&format!("--diameters {spec}"), USAGE, &value(spec, message));
    }
    workplace.put("v.csv", "1\n2\n");
    for (arguments, message) in [
        (
            "--diameters equal(1) --lattice bcc 2",
            "the argument '--diameters <SPEC|FILE>' cannot be used with '--lattice <LATTICE> <N>'",
        ),
        (
            "--volumes v.csv --lattice bcc 2",
            "the argument '--volumes <FILE>' cannot be used with '--lattice <LATTICE> <N>'",
        ),
        ("--volumes v.csv --seeds 2", "the argument '--volumes <FILE>' cannot be used with '--seeds <N>'"),
        (
            "--volumes v.csv --diameters equal(1)",
            "the argument '--volumes <FILE>' cannot be used with '--diameters <SPEC|FILE>'",
        ),
        (
            "--diameters equal(1) --min-diameter 0.2",
            "--min-diameter would change sizes that are given; cut small ones off with from=, or give --seeding random",
        ),
    ] {
        workplace.refuses(arguments, USAGE, message);
    }
    workplace.put("s.csv", ".1,.2,.3\n.5,.5,.5\n.7,.1,.3\n");
    for (arguments, message) in [
        ("--volumes v.csv --seeds-file s.csv", "volumes of v.csv: 2 volumes for 3 seeds; give one for each"),
        (
            "--diameters equal(60) --box 50 50 50",
            "a grain of diameter 60.000000 does not fit the domain; ask for diameters up to 50.000000 (to=50.000000 cuts larger \
             ones off), or use a larger domain",
        ),
        (
            "--diameters equal(60) --dim 2 --box 200 2",
            "a grain of diameter 60.000000 does not fit the domain; ask for diameters up to 22.567583 (to=22.567583 cuts larger \
             ones off), or use a larger domain",
        ),
        (
            "--diameters equal(1e-6)",
            "1909859317102744320 cells would take ... are available; use fewer seeds",
        ),
        ("--diameters none.csv", "none.csv: cannot be read: ... ; give the path of a readable text file"),
        ("--volumes none.csv", "none.csv: cannot be read: ... ; give the path of a readable text file"),
    ] {
        workplace.refuses(arguments, FAILED, message);
    }
}

#[test]
fn file_of_sizes_that_is_mistaken() {
    let workplace = Workplace::new();
    for (option, content, message) in [
        ("diameters", "", "line 1: holds no diameters; give one or more"),
        ("diameters", "diameter\n1\nx\n", "line 3: 'x' is not a number; correct it or remove the line"),
        (
            "diameters",
            "diameter\n# zero\n0\n",
            "line 3: the diameter 0 is not positive and finite; correct it or remove the line",
        ),
        (
            "diameters",
            "size\n1\n",
            "line 1: columns without these names; name a list diameter (or volume), a histogram from, to, weight, and a \
             distribution function diameter, cdf",
        ),
        (
            "diameters",
            "from,to\n1,2\n",
            "line 1: a histogram needs one column of weights, named weight (by number) or volume_fraction",
        ),
        (
            "diameters",
            "from,to,weight\n1,3,2\n2,4,2\n",
            "line 3: the bin from 2 to 4 has no width, or overlaps the one before; list bins from small to large",
        ),
        (
            "diameters",
            "from,to,count\n1,3,-2\n",
            "line 2: the weight -2 is not 0 or more; correct it or remove the line",
        ),
        ("diameters", "from,to,count\n1,3,0\n", "line 1: every weight is 0; give a positive one"),
        (
            "diameters",
            "diameter,cdf\n1,0.1\n2,1\n",
            "line 2: the distribution function begins with 0.1; begin with the smallest diameter and the share 0",
        ),
        (
            "diameters",
            "diameter,cdf\n1,0\n2,1\n1.5,1\n",
            "line 4: diameters and shares of a distribution function must not fall; list them from small to large",
        ),
        (
            "diameters",
            "diameter,n\n1,2\n3\n",
            "line 3: 1 columns, but earlier lines have 2; write the same number on each line",
        ),
        ("volumes", "", "line 1: holds no grains; give one on each line"),
        ("volumes", "a,b\n1,2\n", "line 1: no column is named volume or diameter; name one so"),
        (
            "volumes",
            "volume\n1\n-1\n",
            "line 3: the volume -1 is not positive and finite; correct it or remove the line",
        ),
    ] {
        workplace.put("d.csv", content);
        workplace.refuses(&format!("--{option} d.csv"), FAILED, &format!("d.csv {message}"));
    }
}

/// The points of an .obj file.
fn points(workplace: &Workplace, name: &str) -> Vec<[f64; 3]> {
    let text = String::from_utf8(workplace.bytes(name)).unwrap();
    let point = |line: &str| {
        let mut numbers = line.split_whitespace().map(|word| word.parse().unwrap());
        std::array::from_fn(|_| numbers.next().unwrap())
    };
    text.lines().filter_map(|line| line.strip_prefix("v ")).map(point).collect()
}

/// `check` looked at these triangles as they would be unstretched, and found folds that they do not have.
#[test]
fn elements_of_stretched_grains_are_good_as_they_are() {
    let workplace = Workplace::new();
    let grains = "--seeds 7 --seeding random --rng-seed 3 --aspect-ratio 30 1 1";
    let said = workplace.run(&format!("{grains} -n 2 --elements-per-grain 1 -o a.vtu"));
    assert!(said.contains(" along x, y, z; angles and residual are from before\n"), "{said}");
    workplace.command("check a.vtu").assert().success();
}

/// All is as in the box divided by the stretch, whose factors are 4, 1/2 and 1/2, and is then multiplied by it.
#[test]
fn stretched_grains_are_those_of_the_unstretched_frame() {
    let workplace = Workplace::new();
    for options in [
        "",
        "--periodic x,y,z",
        "--periodic x,y,z --periodic-cut box",
        "--diameters lognormal(mean=1,cv=0.35)",
    ] {
        let run = format!("--seeds 30 {options} -n 1");
        workplace.run(&format!("{run} --box 1 2 2 -o a.obj --json-summary a.json"));
        let said = workplace.run(&format!(
            "{run} --box 4 1 1 --aspect-ratio 8 1 1 -o b.obj -o b.vtp --json-summary b.json --report r.html --stats b_stats.json"
        ));
        let line = "stretched   by 4.0000, 0.5000, 0.5000 along x, y, z; angles, residual and triangles are from before\n";
        assert!(said.contains(line) && said.contains(" in [0, 4] x [0, 1] x [0, 1]"), "{said}");
        let [frame, stretched] = ["a.obj", "b.obj"].map(|name| points(&workplace, name));
        assert_eq!(frame.len(), stretched.len());
        for ([x, y, z], found) in frame.iter().zip(&stretched) {
            assert_eq!([4.0 * x, 0.5 * y, 0.5 * z], *found, "{options}");
        }
        let [frame, stretched] = ["a.json", "b.json"].map(|name| workplace.json(name));
        for same in [
            "angles_before",
            "angles_after",
            "residual",
            "triangle_angles",
            "triple_lines",
            "equivalent_diameter",
        ] {
            assert_eq!(frame[same], stretched[same], "{options}: {same}");
        }
        assert_eq!(
            [&frame["stretch"], &stretched["stretch"]],
            [&Value::Null, &serde_json::json!([4.0, 0.5, 0.5])]
        );
        let report = workplace.command("check --json b.vtp").assert().success().get_output().stdout.clone();
        let report: Value = serde_json::from_slice(&report).unwrap();
        let least = number(&report["files"][0]["triangle_angles"], "least");
        assert!((least / number(&frame["triangle_angles"], "least") - 1.0).abs() < 1e-9, "{least}");
        workplace.run("--config b.vtp -o c.vtp");
        assert!(workplace.bytes("b.vtp") == workplace.bytes("c.vtp"), "{options}");
    }
    workplace.run("--dim 2 --seeds 30 --box 1 4 --cells-json a.json -o a.vtp");
    workplace.run("--dim 2 --seeds 30 --box 2 2 --aspect-ratio 4 1 --cells-json b.json -o b.vtp");
    workplace.command("check b.vtp").assert().success();
    let [frame, stretched] = ["a.json", "b.json"].map(|name| workplace.json(name)["cells"].clone());
    for (frame, stretched) in frame.as_array().unwrap().iter().zip(stretched.as_array().unwrap()) {
        assert!((number(frame, "area") / number(stretched, "area") - 1.0).abs() < 1e-12);
        assert!(
            (2.0 * frame["centroid"][0].as_f64().unwrap() / stretched["centroid"][0].as_f64().unwrap() - 1.0)
                .abs()
                < 1e-12
        );
    }
    // Seeds of a file are where the box has them.
    workplace.put("s.csv", "x,y,z\n.5,.2,.2\n2.8,.3,.4\n3.5,.5,.8\n");
    workplace.run("--seeds-file s.csv --box 4 1 1 --aspect-ratio 2 1 1 --no-mesh --cells-json c.json");
    let seed = &workplace.json("c.json")["cells"][1]["seed"];
    assert!((seed[0].as_f64().unwrap() / 2.8 - 1.0).abs() < 1e-15, "{seed}");
}

#[test]
fn aspect_ratio_that_is_mistaken() {
    let workplace = Workplace::new();
    workplace.put("h.csv", "1,0,0,1\n");
    let range = "a length in proportion is a number from 0.01 to 100";
    for (arguments, message) in [
        ("--aspect-ratio 3 1", "--aspect-ratio takes three numbers, X Y Z, without --dim 2"),
        ("--dim 2 --aspect-ratio 3 1 1", "--aspect-ratio takes two numbers, X Y, with --dim 2"),
        ("--aspect-ratio 3 1 0", &format!("invalid value '0' for '--aspect-ratio <X> <Y> [Z]...': {range}")),
        (
            "--aspect-ratio 3 -1 1",
            &format!("invalid value '-1' for '--aspect-ratio <X> <Y> [Z]...': {range}"),
        ),
        (
            "--aspect-ratio 3 1 1 --lattice sc 2",
            "the argument '--aspect-ratio <X> <Y> [Z]...' cannot be used with '--lattice <LATTICE> <N>'",
        ),
        (
            "--aspect-ratio 3 1 1 --domain sphere",
            "the argument '--aspect-ratio <X> <Y> [Z]...' cannot be used with '--domain <SHAPE>'",
        ),
        (
            "--aspect-ratio 3 1 1 --half-spaces h.csv",
            "the argument '--aspect-ratio <X> <Y> [Z]...' cannot be used with '--half-spaces <FILE>'",
        ),
        (
            "--aspect-ratio 3 1 1 --series a.pvd",
            "the argument '--aspect-ratio <X> <Y> [Z]...' cannot be used with '--series <F>'",
        ),
    ] {
        workplace.refuses(arguments, USAGE, message);
    }
}

#[test]
fn diameters_follow_a_gradient() {
    let workplace = Workplace::new();
    workplace.put("g.csv", "position,factor\n0,1\n2,3\n");
    for (run, axes) in [("--box 1 1 2 --gradient z:g.csv", 3), ("--dim 2 --box 2 1 --gradient x:g.csv", 2)] {
        let run = format!("{run} --seeds 400 --diameters lognormal(mean=1,cv=0.2)");
        workplace.run(&format!("{run} --no-mesh --cells-json c.json"));
        let cells = workplace.json("c.json")["cells"].clone();
        let mut ratios = [Vec::new(), Vec::new()];
        for cell in cells.as_array().unwrap() {
            let position = cell["centroid"][if axes == 3 { 2 } else { 0 }].as_f64().unwrap();
            let ratio = number(cell, "equivalent_diameter") / (1.0 + position);
            ratios[usize::from(position > 1.0)].push(ratio);
        }
        let [small, large] = ratios.map(|all| all.iter().sum::<f64>() / all.len() as f64);
        assert!((small / large - 1.0).abs() < 0.06, "{run}: {small} and {large}");
    }
    let run =
        "--box 1 1 2 --periodic x,y --gradient z:g.csv --diameters lognormal(mean=0.1,cv=0.2) -n 0 --relax 0";
    workplace.run(&format!("{run} --json-summary s.json -o a.vtp --report r.html"));
    let summary = workplace.json("s.json");
    let sizes = &summary["sizes"];
    assert!((number(sizes, "scale") - 1.0).abs() < 0.02, "{sizes}");
    assert!(number(sizes, "cdf_distance") <= 0.5 / number(&summary, "grains") + 1e-9, "{sizes}");
    assert!(number(sizes, "largest_volume_error") < 1e-10, "{sizes}");
    let page = String::from_utf8(workplace.bytes("r.html")).unwrap();
    assert!(
        ["Diameters by number", "Diameters by volume", "asked for"].iter().all(|part| page.contains(part))
    );
    workplace.run("--config a.vtp -o b.vtp");
    assert!(workplace.bytes("a.vtp") == workplace.bytes("b.vtp"));
    for (arguments, message) in [
        (
            "--seeding random --gradient z:g.csv",
            "--gradient changes given sizes; give --diameters or --seeding packed as well",
        ),
        (
            "--dim 2 --seeding packed --gradient z:g.csv",
            "--gradient along z needs three dimensions; with --dim 2 give x or y",
        ),
        (
            "--seeding packed --gradient g.csv",
            "invalid value 'g.csv' for '--gradient <AXIS:FILE>': give an axis and a file, such as z:factors.csv",
        ),
        (
            "--seeding packed --gradient z:g.csv --domain sphere",
            "the argument '--gradient <AXIS:FILE>' cannot be used with '--domain <SHAPE>'",
        ),
    ] {
        workplace.refuses(arguments, USAGE, message);
    }
    for (content, message) in [
        ("", "line 1: holds no factors; give a position and a factor on each line"),
        ("z,f\n1,2\n", "line 1: name two columns position and factor"),
        ("0 1\n1 -1\n", "line 2: the factor -1 at 1 is not from 0.001 to 1000; correct it"),
        ("1 1\n0 2\n", "line 2: the position 0 is not above the one before; list them in order"),
    ] {
        workplace.put("g.csv", content);
        workplace.refuses("--seeding packed --gradient z:g.csv", FAILED, &format!("g.csv {message}"));
    }
}

/// Of so few grains none is large, though a tenth of the volume should be: by number that shows nowhere.
#[test]
fn large_grains_that_are_missing_are_told_by_volume() {
    let workplace = Workplace::new();
    let run = "--diameters 0.9*equal(1)+0.1*equal(10),by=volume -n 0 --relax 0 --json-summary s.json --seeds";
    for (count, least, most) in [("100", 0.099, 0.101), ("5000", 0.0, 0.08)] {
        let said = workplace.run(&format!("{run} {count} --lloyd 0"));
        let sizes = &workplace.json("s.json")["sizes"];
        assert!(number(sizes, "cdf_distance") <= 0.0002, "{sizes}");
        let by_volume = number(sizes, "cdf_distance_by_volume");
        assert!((least..most).contains(&by_volume), "{sizes}");
        assert!(said.contains(&format!(" (by volume {by_volume:.4}),")), "{said}");
    }
}
