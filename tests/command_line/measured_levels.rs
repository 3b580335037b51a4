//! `grainsmooth smooth -n`: networks of maps and of other programs, subdivided.

use crate::maps::npy;
use crate::surface_file::SurfaceFile;
use crate::workplace::{FAILED, USAGE, Workplace};

const MAP: &[u8] = include_bytes!("../data/maps/volume_damask.vti");
const SURFACE_NETS: &[u8] = include_bytes!("../data/surface_nets_good.vtp");

#[test]
fn subdivided_boundaries_go_through_the_points_that_were_there() {
    let workplace = Workplace::new();
    workplace.put("map.vti", MAP);
    for options in ["--decimate 2", "--exterior-label 0 --decimate 3"] {
        workplace.run(&format!("smooth map.vti {options} -o a.vtp"));
        let before = SurfaceFile::read(&workplace.path("a.vtp"));
        for (levels, parts) in [(1, 4), (2, 16)] {
            let said = workplace
                .run(&format!("smooth map.vti {options} -n {levels} -o b.vtp --json-summary b.json"));
            assert!(
                said.contains("validation  good: every grain closed, nothing crossed or folded"),
                "{said}"
            );
            workplace.command("check b.vtp").assert().success();
            let summary = workplace.json("b.json");
            assert!(summary["largest_relative_volume_error"].as_f64().unwrap() < 1e-12, "{summary}");
            let after = SurfaceFile::read(&workplace.path("b.vtp"));
            assert_eq!(after.cells.len(), parts * before.cells.len());
            // Voxels are 0.5, 0.5 and 0.8 wide.
            let pairs = before.points.iter().zip(&after.points);
            let off = pairs.map(|(one, other)| one.distance(*other));
            let mean = off.sum::<f64>() / before.points.len() as f64;
            assert!(mean < 0.02, "{levels}: {mean}");
        }
    }
    // A network of another program, and one that has come to rest before.
    workplace.put("nets.vtp", SURFACE_NETS);
    for options in ["", "--relax 0.05"] {
        workplace.run(&format!("smooth nets.vtp {options} -n 1 -o b.vtp"));
        workplace.command("check b.vtp").assert().success();
    }
    // In the plane.
    let labels: Vec<u8> = (0..20 * 30).map(|pixel| u8::from(pixel % 30 + pixel / 30 > 24)).collect();
    workplace.put("map.npy", npy(&[20, 30], &labels));
    workplace.run("smooth map.npy -n 2 -o b.vtp");
    workplace.command("check b.vtp").assert().success();
    workplace.refuses(
        "smooth map.vti -n 99",
        FAILED,
        "99 levels would take over 1000 EB of memory and ... levels would fit",
    );
    workplace.refuses(
        "smooth map.vti -n -1",
        USAGE,
        "invalid value '-1' for '--levels <LEVELS>': give a whole number from 0 to 99",
    );
}
