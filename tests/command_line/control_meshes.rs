use crate::surface_file::SurfaceFile;
use crate::workplace::{USAGE, Workplace};

fn longest_edge(file: &SurfaceFile) -> f64 {
    let corners = file.cells.iter().flat_map(|cell| cell.iter().zip(cell.iter().cycle().skip(1)));
    corners.map(|(a, b)| file.points[*a].distance(file.points[*b])).fold(0.0, f64::max)
}

#[test]
fn edge_length_bounds_the_control_mesh() {
    let workplace = Workplace::new();
    let made_by = |arguments: &str| {
        workplace.run(&format!("--seeds 12 -n 0 --relax 0 {arguments}"));
        SurfaceFile::read(&workplace.path("grains.vtp"))
    };
    let fan = made_by("");
    let fine = made_by("--edge-length 0.1");
    let plain = made_by("--faces plain");
    assert!(longest_edge(&fan) > 0.2);
    assert!(longest_edge(&fine) < 0.1 + 1e-9);
    assert!(fine.cells.len() > 4 * fan.cells.len());
    // A fan of 2n triangles instead of 2n - 2.
    assert_eq!(plain.cells.len(), fan.cells.len() - 2 * fan.boundary_count());
    for file in [&fine, &plain] {
        assert_eq!(file.boundary_count(), fan.boundary_count());
    }
}

/// Boundaries of regularised cells may have several lines in common, and would have had the same triangle between them.
#[test]
fn plain_boundaries_with_several_common_lines_share_no_edge() {
    let workplace = Workplace::new();
    for arguments in ["--rng-seed 1", "--rng-seed 2", "--rng-seed 3 --periodic x,y,z"] {
        workplace.run(&format!("--seeds 100 -n 1 --faces plain {arguments}"));
        workplace.command("check grains.vtp").assert().success();
    }
}

#[test]
fn edge_lengths_that_are_none_are_refused() {
    let workplace = Workplace::new();
    for value in ["0", "-0.1", "nan", "short"] {
        let message = format!(
            "invalid value '{value}' for '--edge-length <H>': an edge length is a positive number between 1e-30 and 1e30"
        );
        workplace.refuses(&format!("--edge-length {value}"), USAGE, &message);
    }
    let message = "the argument '--edge-length <H>' cannot be used with '--faces <RULE>'";
    workplace.refuses("--edge-length 0.1 --faces plain", USAGE, message);
    // Its points would not fit into any memory.
    workplace.refuses(
        "--edge-length 1e-9 -n 0",
        crate::workplace::FAILED,
        "0 levels would take ... use fewer seeds",
    );
}
