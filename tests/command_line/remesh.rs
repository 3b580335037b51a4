//! `grainsmooth remesh`: networks of files with triangles of a size.

use std::collections::BTreeMap;

use glam::DVec3;
use serde_json::Value;

use crate::surface_file::{SurfaceFile, integers};
use crate::workplace::{FAILED, USAGE, Workplace};

/// Number and volume of each grain in a file of `--stats`, in order.
fn grains(workplace: &Workplace, name: &str) -> Vec<(u64, f64)> {
    let statistics = workplace.json(name);
    let of_grain = |grain: &Value| (grain["SeedId"].as_u64().unwrap(), grain["volume"].as_f64().unwrap());
    statistics["grains"].as_array().unwrap().iter().map(of_grain).collect()
}

#[test]
fn every_network_is_remeshed_with_its_volumes() {
    let workplace = Workplace::new();
    workplace.put("map.vti", include_bytes!("../data/maps/volume_damask.vti"));
    for (name, how) in [
        ("box.vtp", "--seeds 12 -n 1 --texture random --phase a:0.4 --phase b:0.6"),
        ("dream3d.vtu", "--seeds 12 -n 1 --names dream3d"),
        ("stretched.vtk", "--seeds 12 -n 1 --names neper --aspect-ratio 2 1 1"),
        ("periodic.vtp", "--seeds 12 -n 1 --periodic x,y,z --box 2 1 1"),
        ("column.vtk", "--seeds 12 -n 1 --periodic z --names virmat"),
        ("cut.vtp", "--seeds 12 -n 1 --periodic x,y,z --periodic-cut box"),
        ("ball.vtp", "--seeds 6 -n 1 --domain sphere --chord-error 0.05"),
        ("map.vtp", "smooth map.vti --exterior-label 0"),
        ("cells.tess", "--seeds 12 --relax 0 --texture random --phase a:0.4 --phase b:0.6"),
        ("torus.tess", "--seeds 12 --relax 0 --periodic x,y,z --box 2 1 1"),
    ] {
        workplace.run(&format!("{how} -o {name} --stats before.json"));
        let said =
            workplace.run(&format!("remesh {name} --elements-per-grain 3 -o again.vtp --stats after.json"));
        assert!(said.contains("validation  good: every grain closed, nothing crossed or folded"), "{said}");
        workplace.command("check again.vtp").assert().success();
        let [before, after] = ["before.json", "after.json"].map(|name| grains(&workplace, name));
        assert_eq!(before.len(), after.len(), "{name}");
        for ((seed, volume), (same, kept)) in before.into_iter().zip(after) {
            assert!(seed == same && (kept / volume - 1.0).abs() < 1e-9, "{name}, {seed}: {kept}, {volume}");
        }
    }
}

#[test]
fn what_repeats_goes_on_repeating() {
    let workplace = Workplace::new();
    let lengths = DVec3::new(2.0, 1.0, 1.0);
    workplace.run("--seeds 12 -n 1 --periodic x,y,z --box 2 1 1 -o 0.vtp");
    // The last one comes from a file without settings.
    for (from, to) in [("0.vtp", "1.vtp"), ("1.vtp", "2.vtp")] {
        workplace.run(&format!("remesh {from} --elements-per-grain 4 -o {to}"));
        let path = workplace.path(to);
        let (file, originals) = (SurfaceFile::read(&path), integers(&path, "PeriodicOriginal"));
        let mut copies = 0;
        for (point, original) in file.points.iter().zip(&originals) {
            let periods = (point - file.points[usize::try_from(*original).unwrap()]) / lengths;
            assert!((periods - periods.round()).abs().max_element() < 2e-16, "{periods}");
            copies += i32::from(periods.round() != DVec3::ZERO);
        }
        assert!(copies > 200, "{copies}");
        let neighbors = integers(&path, "PeriodicNeighbor");
        assert!(file.face_labels.iter().zip(neighbors).all(|(labels, beyond)| labels[1] >= 0 || beyond >= 0));
    }
    // Opposite walls of a network that was cut are the same, bit for bit.
    workplace.run("--seeds 8 -n 2 --periodic x,y,z --periodic-cut box -o 0.vtp");
    for (from, to, elements) in [("0.vtp", "1.vtp", 6), ("1.vtp", "2.vtp", 3)] {
        workplace.run(&format!("remesh {from} --elements-per-grain {elements} -o {to}"));
        let points = SurfaceFile::read(&workplace.path(to)).points;
        let mut on_walls: BTreeMap<[u64; 2], [usize; 2]> = BTreeMap::new();
        for DVec3 { x, y, z } in points {
            if x == 0.0 || x == 1.0 {
                on_walls.entry([y.to_bits(), z.to_bits()]).or_default()[usize::from(x == 1.0)] += 1;
            }
        }
        assert!(on_walls.len() > 50 && on_walls.values().all(|both| *both == [1, 1]), "{to}");
    }
}

#[test]
fn phases_and_orientations_ride_along() {
    let workplace = Workplace::new();
    workplace.run(
        "--seeds 8 -n 1 --texture random --phase a:0.4 --phase b:0.6,symmetry=hexagonal -o 0.vtp --stats 0.json",
    );
    let of = |name: &str| -> Vec<f64> {
        let statistics = workplace.json(name);
        let grains = statistics["grains"].as_array().unwrap().iter();
        let numbers = grains.flat_map(|grain| {
            let quaternion =
                grain["Quaternion"].as_array().unwrap().iter().map(|number| number.as_f64().unwrap());
            quaternion.chain(grain["Phase"].as_f64()).collect::<Vec<_>>()
        });
        numbers.collect()
    };
    let before = of("0.json");
    for (from, to) in [("0", "1"), ("1", "2")] {
        workplace.run(&format!(
            "remesh {from}.vtp --elements-per-grain 3 -o {to}.vtp --stats {to}.json --picture {to}.png --picture-size 200 200 --color-by phase"
        ));
        let after = of(&format!("{to}.json"));
        assert!(after.len() == 40 && before.iter().zip(after).all(|(a, b)| (a - b).abs() < 1e-12), "{to}");
    }
    let symmetries = String::from_utf8_lossy(&workplace.bytes("2.vtp")).contains("432,622");
    assert!(symmetries, "the crystals keep their symmetries");
}

#[test]
fn coarse_triangles_are_the_surface_themselves() {
    let workplace = Workplace::new();
    // Flat cells with edges that are longer than elements.
    workplace.run("--seeds 5 --seeding random -n 0 --relax 0 -o flat.vtp");
    let said = workplace.run("remesh flat.vtp --elements-per-grain 8 -o fine.vtp");
    assert!(said.contains("validation  good"), "{said}");
    workplace.command("check fine.vtp").assert().success();
}

#[test]
fn what_cannot_be_remeshed_is_refused() {
    let workplace = Workplace::new();
    workplace.put("nets.vtp", include_bytes!("../data/surface_nets_good.vtp"));
    workplace.put("open.vtp", include_bytes!("../data/surface_nets_touching.vtp"));
    workplace.run("--seeds 3 -n 0 -o a.vtp");
    for (options, message) in [
        (
            "nets.vtp",
            "remesh needs a size of elements; give --elements-per-grain, such as --elements-per-grain 5, or --element-size",
        ),
        (
            "nets.vtp --element-size 1 --picture a.png --color-by ipf-z",
            "--color-by ipf-z needs orientations, which nets.vtp does not hold; leave it out",
        ),
        (
            "a.vtp --element-size 0.2 --volume-mesh",
            "--volume-mesh writes tetrahedra, but none of the files can hold them; give one of .vtu, .msh, .inp and .bdf, such as -o grains.vtu",
        ),
    ] {
        workplace.refuses(&format!("remesh {options}"), USAGE, message);
    }
    workplace.refuses(
        "remesh none.vtp --element-size 1",
        FAILED,
        "none.vtp: cannot be read: No such file or directory (os error 2); give the path of a readable mesh file",
    );
    workplace.refuses("remesh open.vtp --element-size 1", FAILED, "open.vtp: ... ");
}

#[test]
fn short_lines_are_kept_where_they_cannot_become_points() {
    let workplace = Workplace::new();
    let network = "--dim 2 --seeds 60 --rng-seed 38 --elements-per-grain 0.7 -o a.vtp";
    let invalid = "with elements of that size the network is invalid:";
    let remedy = "give another size, or more levels of subdivision; with --small-features keep, which leaves short lines as they are, it works";
    let message = format!("{invalid} ... {remedy}");
    workplace.refuses(&format!("{network} --small-features merge"), FAILED, &message);
    workplace.run(&format!("{network} --small-features keep"));
}

/// Along the sharp edges of thin grains, neighbouring triangles of whatever size were folded: none flipped for that.
#[test]
fn thin_grains_whose_boundaries_bend_sharply_are_remeshed() {
    Workplace::new().run(
        "--seeds 12 --rng-seed 2 --grain-shapes 3:1:1 --relax 0.05 -n 2 --elements-per-grain 3 -o a.vtp",
    );
}

/// What rounding leaves of the sum of all volumes was shared out evenly: more than a small grain has.
#[test]
fn grains_a_thousandth_as_wide_keep_their_volumes() {
    let workplace = Workplace::new();
    let place = |k: u32| (DVec3::new(0.819, 0.671, 0.550) * f64::from(k)).fract();
    let small = (41..=52).map(|k| place(k) * 1e-3 + 0.5);
    let seeds = small.chain((53..=60).map(place)).map(|seed| format!("{} {} {}", seed.x, seed.y, seed.z));
    workplace.put("seeds.txt", seeds.collect::<Vec<_>>().join("\n"));
    workplace.run("--seeds-file seeds.txt --relax 0.1 -n 2 --elements-per-grain 1.5 -o a.vtp");
}

/// Elements once grew from lines of 1e-11 in seventy rings, which took minutes.
#[test]
fn lines_too_short_for_elements_are_refused_with_the_remedy() {
    let workplace = Workplace::new();
    let shift = |k: u32| 1e-11 * f64::from(k * k % 7);
    let seed = |k: u32| {
        let [x, y, z] =
            [k / 4, k / 2 % 2, k % 2].map(|place| 0.25 + 0.5 * f64::from(place) + shift(k + place));
        format!("{x} {y} {z}\n")
    };
    workplace.put("seeds.txt", (0..8).map(seed).collect::<String>().into_bytes());
    let network = "--seeds-file seeds.txt -n 1 --elements-per-grain 2 -o a.vtp";
    let message = "a triple line is only ... long: elements beside it would be a millionth of 0.310 and less, too small for any solver; relax it without --relax 0 and --regularize 0, or merge short lines with --small-features merge";
    for kept in ["--relax 0", "--regularize 0 --relax 0.01"] {
        workplace.refuses(&format!("{network} {kept}"), FAILED, message);
    }
    workplace.run(network);
}

#[test]
fn equations_are_for_networks_that_repeat() {
    let workplace = Workplace::new();
    if grainsmooth::check_gmsh().is_err() {
        return crate::programs::skip("equations_are_for_networks_that_repeat", "there is no Gmsh");
    }
    workplace.run("--seeds 3 -n 0 -o a.vtp");
    workplace.refuses(
        "remesh a.vtp --element-size 0.3 --periodic-equations -o a.inp",
        USAGE,
        "--periodic-equations ties nodes that are one period apart, and this network does not repeat; leave it out",
    );
    workplace.run("--seeds 3 -n 1 --domain sphere --chord-error 0.1 -o ball.vtp");
    workplace.refuses(
        "remesh ball.vtp --element-size 0.3 --solver-deck tension-x -o a.inp",
        USAGE,
        "--solver-deck loads a box that grains fill, periodic along all axes or none; leave it out",
    );
}
