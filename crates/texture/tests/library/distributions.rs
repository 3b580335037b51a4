//! What is drawn, against exact distributions.

use std::collections::BTreeMap;

use crate::common::load;
use glam::DVec3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde::Deserialize;
use texture::{
    Component, CrystalSymmetry, Drawn, FiberKernel, Kernel, Orientation, PoleFigure, Projection,
    RandomDisorientations, SampleSymmetry, Texture, texture_index,
};

fn drawn(spec: &str, volumes: &[f64], seed: u64) -> Drawn {
    let texture: Texture = spec.parse().expect("the text is a texture");
    texture.draw(volumes, &mut ChaCha8Rng::seed_from_u64(seed)).expect("volumes are positive")
}

/// Volumes of grains whose diameters are uniform from 0.4 to 1.6.
fn volumes(count: usize) -> Vec<f64> {
    let mut generator = ChaCha8Rng::seed_from_u64(5);
    let mut fraction = || f64::from(generator.next_u32()) / 2f64.powi(32);
    (0..count).map(|_| (0.4 + 1.2 * fraction()).powi(3)).collect()
}

#[derive(Deserialize)]
struct Kernels {
    rotations: Vec<OfRotation>,
    fibers: Vec<OfFiber>,
}

#[derive(Deserialize)]
struct OfRotation {
    halfwidth_deg: f64,
    kappa: f64,
    peak: f64,
    sharpness: f64,
    mean_angle_deg: f64,
    quantiles: BTreeMap<String, f64>,
}

#[derive(Deserialize)]
struct OfFiber {
    halfwidth_deg: f64,
    peak: f64,
    tilt_quantiles_deg: BTreeMap<String, f64>,
}

fn is_near(ours: f64, theirs: f64, digits: f64) -> bool {
    (ours / theirs - 1.0).abs() < digits
}

#[test]
fn kernels_have_the_published_peaks_sharpness_and_quantiles() {
    let kernels: Kernels = load("kernels.json");
    for reference in kernels.rotations {
        let kernel = Kernel::new(reference.halfwidth_deg).unwrap();
        assert!(is_near(kernel.exponent(), reference.kappa, 1e-9));
        assert!(is_near(kernel.density(0.0), reference.peak, 1e-9));
        assert!(is_near(kernel.density(reference.halfwidth_deg), reference.peak / 2.0, 1e-9));
        assert!(is_near(kernel.sharpness(), reference.sharpness, 1e-9));
        for (share, angle) in reference.quantiles {
            let share: f64 = share.parse().unwrap();
            assert!(is_near(kernel.angle_within(share), angle, 1e-7), "{} {share}", reference.halfwidth_deg);
            assert!((kernel.share_within(angle) - share).abs() < 1e-7);
        }
        let strata = 1000;
        let angles =
            (0..strata).map(|index| kernel.angle_within((f64::from(index) + 0.5) / f64::from(strata)));
        assert!(is_near(angles.sum::<f64>() / f64::from(strata), reference.mean_angle_deg, 1e-3));
    }
    for reference in kernels.fibers {
        let kernel = FiberKernel::new(reference.halfwidth_deg).unwrap();
        assert!(is_near(kernel.density(1.0), reference.peak, 1e-8));
        let at_half = kernel.density(reference.halfwidth_deg.to_radians().cos());
        assert!(is_near(at_half, reference.peak / 2.0, 1e-8));
        for (share, tilt) in reference.tilt_quantiles_deg {
            assert!(is_near(kernel.tilt_within(share.parse().unwrap()), tilt, 1e-7));
        }
    }
    // The narrowest and the widest are drawn too.
    for halfwidth in [0.01, 0.1, 90.0] {
        let kernel = Kernel::new(halfwidth).unwrap();
        for share in [0.0, 1e-9, 0.5, 1.0 - 1e-9] {
            let angle = kernel.angle_within(share);
            assert!((kernel.share_within(angle) - share).abs() < 1e-9, "{halfwidth} {share} {angle}");
        }
    }
}

/// Largest difference between quantiles of some values, each with a weight, and a distribution.
fn distance(mut weighted: Vec<(f64, f64)>, share_below: impl Fn(f64) -> f64) -> f64 {
    weighted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = weighted.iter().map(|(_, weight)| weight).sum();
    let (mut before, mut largest) = (0.0, 0.0_f64);
    for (value, weight) in weighted {
        let exact = share_below(value);
        largest = largest.max((exact - before).abs());
        before += weight / total;
        largest = largest.max((exact - before).abs());
    }
    largest
}

#[test]
fn components_are_spread_as_their_kernels_by_volume() {
    let volumes = volumes(2000);
    for (spec, halfwidth) in [("goss(10)", 10.0), ("s(3)", 3.0), ("{112}<-1-11>(25)", 25.0)] {
        let texture: Texture = spec.parse().unwrap();
        let (component, ..) = texture.components().next().unwrap();
        let Component::Peak { mode, .. } = component else { panic!("{spec} is no peak") };
        let kernel = Kernel::new(halfwidth).unwrap();
        let drawn = drawn(spec, &volumes, 1);
        let angle = |orientation| CrystalSymmetry::Triclinic.disorientation_angle(orientation, *mode);
        let angles = drawn.orientations.iter().zip(&volumes).map(|(one, volume)| (angle(*one), *volume));
        // Strata are some thousandth of the volume; independent draws would be off by 0.03.
        let off = distance(angles.collect(), |angle| kernel.share_within(angle));
        assert!(off < 0.004, "{spec}: {off}");
        // The axis is uniform: each component's mean is 0, its mean square a third.
        let [w, x, y, z] = mode.quaternion();
        let back = glam::DQuat::from_xyzw(x, y, z, w).conjugate();
        let total: f64 = volumes.iter().sum();
        let mut means = [DVec3::ZERO; 2];
        for (orientation, volume) in drawn.orientations.iter().zip(&volumes) {
            let [w, x, y, z] = orientation.quaternion();
            let axis = (glam::DQuat::from_xyzw(x, y, z, w) * back).xyz().normalize();
            let axis = if (glam::DQuat::from_xyzw(x, y, z, w) * back).w < 0.0 { -axis } else { axis };
            means[0] += *volume / total * axis;
            means[1] += *volume / total * axis * axis;
        }
        assert!(means[0].abs().max_element() < 0.06, "{spec}: {}", means[0]);
        assert!((means[1] - 1.0 / 3.0).abs().max_element() < 0.05, "{spec}: {}", means[1]);
    }
}

#[test]
fn fibers_tilt_as_their_kernel_and_turn_freely() {
    let volumes = volumes(2000);
    for (spec, crystal, sample, halfwidth) in [
        ("fiber(111||z, 10)", DVec3::ONE, DVec3::Z, 10.0),
        ("fiber(-1 1 2||1 1 0, 5)", DVec3::new(-1.0, 1.0, 2.0), DVec3::new(1.0, 1.0, 0.0), 5.0),
        // Antiparallel ones have no shortest way.
        ("fiber(00-1||nd, 20)", DVec3::NEG_Z, DVec3::Z, 20.0),
    ] {
        let drawn = drawn(spec, &volumes, 2);
        let tilt = |one: &Orientation| one.to_sample(crystal).angle_between(sample).to_degrees();
        let tilts = drawn.orientations.iter().zip(&volumes).map(|(one, volume)| (tilt(one), *volume));
        // 1 - U of the density (1 + k) U^(k / (k + 1)).
        let exponent = Kernel::new(halfwidth).unwrap().exponent();
        let share = |tilt: f64| 1.0 - (0.5 * (1.0 + tilt.to_radians().cos())).powf(exponent + 1.0);
        let off = distance(tilts.collect(), share);
        assert!(off < 0.004, "{spec}: {off}");
        // The angle of another direction around the fiber is uniform.
        let around = |one: &Orientation| {
            let seen = one.to_crystal(sample.any_orthogonal_vector());
            let [a, b] = crystal.normalize().any_orthonormal_pair().into();
            seen.dot(b).atan2(seen.dot(a)).to_degrees() + 180.0
        };
        let turns = drawn.orientations.iter().zip(&volumes).map(|(one, volume)| (around(one), *volume));
        let off = distance(turns.collect(), |angle| angle / 360.0);
        assert!(off < 0.03, "{spec}: {off}");
    }
}

#[test]
fn pairs_of_2000_random_orientations_are_disoriented_as_mackenzie_says() {
    #[derive(Deserialize)]
    struct Random {
        groups: BTreeMap<String, Group>,
    }
    #[derive(Deserialize)]
    struct Group {
        bins: Vec<f64>,
    }
    let reference: Random = load("random_disorientations.json");
    let orientations = drawn("random", &[1.0; 2000], 3).orientations;
    for group in ["432", "622"] {
        let symmetry: CrystalSymmetry = group.parse().unwrap();
        let bins = &reference.groups[group].bins;
        let mut counts = vec![0.0; bins.len()];
        for (index, first) in orientations.iter().enumerate() {
            for second in &orientations[..index] {
                #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // From 0 to 93 degrees.
                let bin = (symmetry.disorientation_angle(*first, *second) / 5.0) as usize;
                counts[bin] += 1.0 / (2000.0 * 1999.0 / 2.0);
            }
        }
        for (ours, exact) in counts.iter().zip(bins) {
            assert!((ours - exact).abs() < 0.002, "{group}: {counts:?} is not {bins:?}");
        }
    }
}

#[test]
fn random_disorientations_have_the_published_shares_densities_and_means() {
    #[derive(Deserialize)]
    struct Random {
        groups: BTreeMap<String, Group>,
    }
    #[derive(Deserialize)]
    struct Group {
        largest: f64,
        mean: f64,
        bins: Vec<f64>,
        density: BTreeMap<String, f64>,
    }
    let reference: Random = load("random_disorientations.json");
    assert_eq!(reference.groups.len(), 6);
    for (name, group) in reference.groups {
        let random = RandomDisorientations::new(name.parse().unwrap());
        assert!((random.mean() - group.mean).abs() < 2e-4, "{name}: {}", random.mean());
        assert!((random.largest() - group.largest).abs() < 0.3, "{name}: {}", random.largest());
        assert_eq!(random.share_below(180.0), random.share_below(group.largest + 0.01));
        assert!((random.share_below(180.0) - 1.0).abs() < 1e-4);
        let mut angle = 0.0;
        for bin in group.bins {
            let share = random.share_below(angle + 5.0) - random.share_below(angle);
            assert!((share - bin).abs() < 2e-6, "{name} from {angle}: {share} is not {bin}");
            angle += 5.0;
        }
        for (angle, exact) in group.density {
            let density = random.density(angle.parse().unwrap());
            assert!((density - exact).abs() < 2e-6, "{name} at {angle}: {density} is not {exact}");
        }
    }
}

#[test]
fn components_have_their_volumes_within_a_hundredth() {
    for (count, seed) in [(200, 1), (1000, 2)] {
        let volumes = volumes(count);
        let total: f64 = volumes.iter().sum();
        let drawn = drawn("cube(5)*0.3 + goss(10)*0.25 + random*0.45", &volumes, seed);
        for (component, wanted) in [0.3, 0.25, 0.45].into_iter().enumerate() {
            let members = volumes.iter().zip(&drawn.components).filter(|(_, number)| **number == component);
            let share = members.map(|(volume, _)| volume).sum::<f64>() / total;
            assert!((share - wanted).abs() < 0.01 * wanted, "{share} is not {wanted}");
        }
    }
}

/// The component with the smaller share once had the smaller grains: their mean diameter was 0.77 of the others'.
#[test]
fn components_of_any_share_have_grains_alike_in_size() {
    let volumes = volumes(500);
    let Drawn { components, .. } = drawn("goss(10)*0.2 + random*0.8", &volumes, 5);
    let mean_diameter = |component: usize| {
        let of = components.iter().zip(&volumes).filter(|(of, _)| **of == component);
        let diameters: Vec<f64> = of.map(|(_, volume)| volume.cbrt()).collect();
        diameters.iter().sum::<f64>() / diameters.len() as f64
    };
    let ratio = mean_diameter(0) / mean_diameter(1);
    assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
}

#[test]
fn equal_volumes_in_the_order_of_a_lattice_do_not_get_components_in_turn() {
    let drawn = drawn("cube(5)*0.5 + random*0.5", &[1.0; 1000], 4);
    let same = drawn.components.windows(2).filter(|pair| pair[0] == pair[1]).count();
    // 500 of 999 are expected, with a standard deviation of 16.
    assert!((430..570).contains(&same), "{same}");
}

#[test]
fn lists_are_drawn_by_weight_and_sample_symmetry_gives_all_variants_alike() {
    let euler = [[0.0, 0.0, 0.0], [35.0, 45.0, 0.0], [10.0, 20.0, 30.0]];
    let weights = [0.5, 0.0, 1.5];
    let listed: Vec<_> = euler.map(Orientation::from_euler_degrees).into_iter().zip(weights).collect();
    let texture = Texture::of_list(&listed, None, "list").unwrap();
    let drawn = texture.draw(&[1.0; 400], &mut ChaCha8Rng::seed_from_u64(1)).unwrap();
    let counts =
        listed.iter().map(|(wanted, _)| drawn.orientations.iter().filter(|one| *one == wanted).count());
    assert_eq!(counts.collect::<Vec<_>>(), [100, 0, 300]);
    assert!(Texture::of_list(&[], None, "list").is_none());

    let brass: Texture = "brass(0)".parse().unwrap();
    let brass = brass.with_sample_symmetry(SampleSymmetry::Orthorhombic);
    let drawn = brass.draw(&[1.0; 400], &mut ChaCha8Rng::seed_from_u64(1)).unwrap();
    let mut variants: Vec<(Orientation, usize)> = Vec::new();
    for one in &drawn.orientations {
        let angle = |other: Orientation| CrystalSymmetry::Octahedral.disorientation_angle(*one, other);
        match variants.iter_mut().find(|(other, _)| angle(*other) < 1e-9) {
            Some((_, count)) => *count += 1,
            None => variants.push((*one, 1)),
        }
    }
    // Brass has two that differ in the crystal.
    assert_eq!(variants.iter().map(|(_, count)| *count).collect::<Vec<_>>(), [200, 200]);
}

#[test]
fn same_generator_gives_the_same_orientations() {
    let volumes = volumes(50);
    let spec = "cube(5)*0.3+random*0.7";
    assert_eq!(drawn(spec, &volumes, 9), drawn(spec, &volumes, 9));
    assert_ne!(drawn(spec, &volumes, 9), drawn(spec, &volumes, 10));
    let texture: Texture = spec.parse().unwrap();
    let error = texture.draw(&[1.0, 0.0], &mut ChaCha8Rng::seed_from_u64(1)).unwrap_err();
    assert_eq!(error.to_string(), "volume 0 of item 1 is not positive and finite");
}

#[test]
fn densities_have_the_mean_one_and_the_peak_of_the_kernel_over_the_order() {
    let uniform = drawn("random", &[1.0; 20_000], 1).orientations;
    for spec in ["goss(20)", "fiber(110||x, 20)", "cube(15)*0.5 + random*0.5"] {
        for sample in [SampleSymmetry::Triclinic, SampleSymmetry::Orthorhombic] {
            let texture = spec.parse::<Texture>().unwrap().with_sample_symmetry(sample);
            let sum: f64 = uniform.iter().map(|one| texture.density(*one, CrystalSymmetry::Octahedral)).sum();
            assert!((sum / 20_000.0 - 1.0).abs() < 0.05, "{spec}: {}", sum / 20_000.0);
        }
    }
    let cube: Texture = "cube(10)".parse().unwrap();
    let peak = Kernel::new(10.0).unwrap().density(0.0) / 24.0;
    assert!(is_near(cube.density(Orientation::IDENTITY, CrystalSymmetry::Octahedral), peak, 1e-6));
}

#[test]
fn pole_figures_of_random_textures_are_one_and_peaks_stand_where_poles_do() {
    let kernel = FiberKernel::new(10.0).unwrap();
    let weighted = |spec: &str| -> Vec<(Orientation, f64)> {
        drawn(spec, &[1.0; 4000], 6).orientations.into_iter().map(|one| (one, 1.0)).collect()
    };
    let cubic = CrystalSymmetry::Octahedral;
    let random = weighted("random");
    for figure in [
        PoleFigure::of_crystal_axis(&random, cubic, DVec3::ONE, kernel),
        PoleFigure::of_sample_axis(&random, cubic, DVec3::X, kernel),
    ] {
        for direction in [DVec3::X, DVec3::Z, DVec3::ONE, DVec3::new(0.3, -0.5, 0.1)] {
            let density = figure.density(direction);
            assert!((density - 1.0).abs() < 0.15, "{direction}: {density}");
        }
    }
    // Of one crystal, smoothed by the kernel alone: {100} has three axes, each a kernel and its opposite.
    let goss = PoleFigure::of_crystal_axis(&weighted("goss(0)"), cubic, DVec3::X, kernel);
    let peak = kernel.density(1.0) / 6.0;
    assert!(is_near(goss.density(DVec3::X), peak, 1e-6));
    assert!(is_near(goss.density(DVec3::new(0.0, 1.0, -1.0)), peak, 1e-6));
    assert!(goss.density(DVec3::new(1.0, 0.3, 0.8)) < 0.1);
    // In the crystal, the normal direction is one of the six {110} and their opposites.
    let inverse = PoleFigure::of_sample_axis(&weighted("goss(0)"), cubic, DVec3::Z, kernel);
    for direction in [DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.0, -1.0, 1.0)] {
        assert!(is_near(inverse.density(direction), kernel.density(1.0) / 12.0, 1e-6));
    }
}

#[test]
fn projections_lead_back_and_equal_areas_stay_equal() {
    for projection in [Projection::EqualArea, Projection::Stereographic] {
        for direction in [DVec3::X, DVec3::Z, DVec3::ONE, DVec3::new(-0.3, 0.5, -0.9)] {
            let unit = direction.normalize();
            let upper = if unit.z < 0.0 { -unit } else { unit };
            let back = projection.direction(projection.project(direction)).unwrap();
            assert!(back.abs_diff_eq(upper, 1e-14), "{direction}: {back}");
        }
        assert_eq!(projection.direction([0.8, 0.8]), None);
        let [x, y] = projection.project(DVec3::NEG_Y);
        assert!(x.abs() < 1e-15 && (y + 1.0).abs() < 1e-15);
    }
    // Half of the upper half lies above 30 degrees from the rim (z = 1/2), and so within a radius of sqrt(1/2).
    let tilted = DVec3::new(0.75_f64.sqrt(), 0.0, 0.5);
    assert!((Projection::EqualArea.project(tilted)[0] - 0.5_f64.sqrt()).abs() < 1e-15);
    assert!((Projection::Stereographic.project(tilted)[0] - 30_f64.to_radians().tan()).abs() < 1e-15);
}

/// A density smoothed by a kernel, at what it was drawn from: with the halfwidth h of the mode and of the kernel, that of `h sqrt(3)` or so
/// at its middle, as squares of small halfwidths add up.
#[test]
fn measured_orientations_have_the_index_of_their_texture() {
    let equal = vec![1.0; 600];
    let index = |spec: &str, symmetry, halfwidth| {
        let orientations = drawn(spec, &equal, 4).orientations;
        let weighted: Vec<(Orientation, f64)> = orientations.into_iter().map(|one| (one, 1.0)).collect();
        texture_index(&weighted, Kernel::new(halfwidth).unwrap(), symmetry).unwrap()
    };
    for symmetry in [CrystalSymmetry::Octahedral, CrystalSymmetry::Hexagonal, CrystalSymmetry::Triclinic] {
        let random = index("random", symmetry, 10.0);
        assert!((random - 1.0).abs() < 0.1, "{symmetry}: {random}");
    }
    let of_mode = |halfwidth: f64| Kernel::new(halfwidth).unwrap().density(0.0) / 24.0;
    let goss = index("goss(6)", CrystalSymmetry::Octahedral, 3.0);
    let expected = of_mode((2.0 * 6f64.powi(2) + 3f64.powi(2)).sqrt());
    assert!((goss / expected - 1.0).abs() < 0.1, "{goss} {expected}");
    let mixed = index("goss(6)*0.5 + random*0.5", CrystalSymmetry::Octahedral, 3.0);
    assert!((mixed / (0.25 * expected + 0.75) - 1.0).abs() < 0.1, "{mixed}");
    assert_eq!(texture_index(&[], Kernel::new(5.0).unwrap(), CrystalSymmetry::Octahedral), None);
}
