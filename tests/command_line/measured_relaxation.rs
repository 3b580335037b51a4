//! `grainsmooth smooth --relax`: networks of maps and of other programs nearer to equilibrium.

use crate::surface_file::SurfaceFile;
use crate::workplace::{FAILED, USAGE, Workplace};

const MAP: &[u8] = include_bytes!("../data/maps/volume_damask.vti");
const SURFACE_NETS: &[u8] = include_bytes!("../data/surface_nets_good.vtp");

fn workplace() -> Workplace {
    let workplace = Workplace::new();
    workplace.put("map.vti", MAP);
    workplace.put("nets.vtp", SURFACE_NETS);
    workplace
}

/// The root of the mean square of what the tensions leave at triple lines, as the summary tells it.
fn residual(said: &str) -> f64 {
    let line = said.lines().find_map(|line| line.strip_prefix("residual ")).unwrap();
    line.split_whitespace().next().unwrap().parse().unwrap()
}

/// Labels in the map, and volumes.
fn grains(workplace: &Workplace, name: &str) -> Vec<(u64, f64)> {
    let statistics = workplace.json(name);
    let of_grain =
        |grain: &serde_json::Value| (grain["SeedId"].as_u64().unwrap(), grain["volume"].as_f64().unwrap());
    statistics["grains"].as_array().unwrap().iter().map(of_grain).collect()
}

#[test]
fn boundaries_of_maps_come_to_rest_with_their_volumes() {
    let workplace = workplace();
    // With a pore, whose surface no wall holds, and without. The pore is few voxels wide, and its surface has no tension: with all edges kept it crosses itself at some later times.
    for (options, time) in [("", 0.1), ("--exterior-label 0", 0.1), ("--exterior-label 0 --decimate 0", 0.05)]
    {
        let as_measured = workplace.run(&format!("smooth map.vti {options} -o a.vtp --stats a.json"));
        let relaxed =
            workplace.run(&format!("smooth map.vti {options} --relax {time} -o b.vtp --stats b.json"));
        assert!(relaxed.contains("validation  good: every grain closed, nothing crossed or folded"));
        workplace.command("check b.vtp").assert().success();
        assert!(residual(&relaxed) < 0.6 * residual(&as_measured), "{relaxed}");
        let [measured, at_rest] = ["a.json", "b.json"].map(|name| grains(&workplace, name));
        for ((label, volume), (same, kept)) in measured.into_iter().zip(at_rest) {
            assert!(label == same && (kept / volume - 1.0).abs() < 1e-9, "{label}: {kept}, {volume}");
        }
    }
    // None is the default.
    workplace.run("smooth map.vti --relax 0 -o b.vtp");
    workplace.run("smooth map.vti -o a.vtp");
    let [one, other] = ["a.vtp", "b.vtp"].map(|name| SurfaceFile::read(&workplace.path(name)));
    assert!(one.points == other.points);
}

#[test]
fn networks_of_any_program_come_to_rest() {
    let workplace = workplace();
    workplace.run("smooth map.vti --exterior-label 0 -o map.vtp --stats map.json");
    workplace.run("smooth map.vtp --relax equilibrium -o b.vtp --stats b.json");
    workplace.command("check b.vtp").assert().success();
    let [measured, at_rest] = ["map.json", "b.json"].map(|name| grains(&workplace, name));
    // The labels of the map that the network came from are still known.
    assert_eq!(at_rest.iter().map(|(label, _)| *label).collect::<Vec<_>>(), (1..10).collect::<Vec<_>>());
    for ((_, volume), (label, kept)) in measured.into_iter().zip(at_rest) {
        assert!((kept / volume - 1.0).abs() < 1e-9, "{label}: {kept}, {volume}");
    }
    // VTK numbers these grains from 1: three in a cube of 6.
    let said = workplace.run("smooth nets.vtp --relax equilibrium -o b.vtu --stats b.json");
    workplace.command("check b.vtu").assert().success();
    assert!(residual(&said) < 0.15, "{said}");
    let (labels, volumes): (Vec<u64>, Vec<f64>) = grains(&workplace, "b.json").into_iter().unzip();
    assert_eq!(labels, [1, 2, 3]);
    assert!((volumes.iter().sum::<f64>() - 216.0).abs() < 1e-9);
    // In the plane, with settings of a run whose coordinates were multiplied in the end.
    workplace.run("--dim 2 --seeds 20 --relax 0 --aspect-ratio 2 1 -o plane.vtp");
    let said = workplace.run("smooth plane.vtp --relax equilibrium -o b.vtp");
    assert!(said.contains("validation  good"), "{said}");
    let [before, after] = ["plane.vtp", "b.vtp"].map(|name| SurfaceFile::read(&workplace.path(name)));
    let width = |file: &SurfaceFile| file.points.iter().map(|point| point[0]).fold(0.0, f64::max);
    assert_eq!(width(&before), width(&after));
}

#[test]
fn what_cannot_be_relaxed_is_refused() {
    let workplace = workplace();
    workplace.refuses(
        "smooth nets.vtp",
        USAGE,
        "nets.vtp is a network already; give --relax, such as --relax equilibrium, or -n",
    );
    workplace.refuses(
        "smooth nets.vtp --relax 0.1 --min-voxels 4",
        USAGE,
        "nets.vtp is a network, not a map; leave --min-voxels out",
    );
    workplace.refuses(
        "smooth nets.vtp --relax 0.1 --decimate 3",
        USAGE,
        "nets.vtp is a network, not a map; leave --decimate out",
    );
    workplace.refuses(
        "smooth none.vtp --relax 0.1",
        FAILED,
        "none.vtp: cannot be read: No such file or directory (os error 2); give the path of a readable mesh file",
    );
    workplace.refuses(
        "smooth map.vti --relax -1",
        USAGE,
        "invalid value '-1' for '--relax <T>': the relaxation time is 0 (off), a positive, finite number, or equilibrium",
    );
}
