//! How triangles of one size are drawn, and elements that fill grains.

use crate::case::{AngleClass, Case};
use crate::domain::Domain;
use crate::draw::Draw;

/// Share of runs whose boundaries have triangles of a size that is asked for.
const REMESHED: f64 = 0.15;

/// Share of those whose grains are filled.
const FILLED: f64 = 0.75;

/// Diameter of a ball, or of a disc, in units of the side of the cube or square that it is as large as.
const DIAMETERS: [f64; 2] = [1.128, 1.241];

/// Elements to a diameter from which on boundaries need a level more.
const FINE: f64 = 5.0;

/// Draws sizes of elements for a run that writes a network, and what fills its grains, after all else.
pub fn draw(draw: &mut Draw, domain: &Domain, count: u32, case: &mut Case) {
    let is_taken = ["no-mesh", "dry-run"].iter().any(|name| case.options.has(name));
    if is_taken || !draw.chance(REMESHED) {
        return;
    }
    let options = &mut case.options;
    let per_grain = draw.magnitude(2.0, 8.0);
    if draw.chance(0.3) {
        let diameter = DIAMETERS[case.dimension - 2] * domain.spacing(count);
        options.set("element-size", [diameter / per_grain]);
    } else {
        options.set("elements-per-grain", [per_grain]);
    }
    if draw.chance(0.15) {
        options.set("adapt-curvature", [draw.between(0.2, 1.0)]);
    }
    if draw.chance(0.15) {
        options.set("size-growth", [draw.magnitude(0.1, 2.0)]);
    }
    if case.dimension == 3 {
        case.angles = AngleClass::Remeshed;
        // What is finer already may be too fine for another level.
        if !options.has("edge-length") {
            options.set("levels", [if per_grain < FINE { 2 } else { 3 }]);
        }
    }
    if draw.chance(FILLED) {
        fill(draw, domain, case);
    }
    if draw.chance(0.15) {
        case.options.set("small-features", ["merge"]);
    }
}

/// Draws a file of elements that fill grains, and what solvers need in it.
fn fill(draw: &mut Draw, domain: &Domain, case: &mut Case) {
    let options = &mut case.options;
    let mut outputs = options.values("output").to_vec();
    let is_written = |extension: &str| {
        outputs.iter().any(|name| name.ends_with(extension)) || options.value("format") == Some(extension)
    };
    // These hold boundaries unless all of them hold elements; and with voxels two hold hexahedra.
    let may_hold_either = !is_written("vtu") && !is_written("msh");
    let holds_voxels = options.has("voxels");
    let formats = [
        (if holds_voxels { 0.0 } else { 0.5 }, "inp"),
        (0.1, "bdf"),
        (0.1, "xdmf"),
        (if may_hold_either { 0.2 } else { 0.0 }, "msh"),
        (if may_hold_either && !holds_voxels { 0.2 } else { 0.0 }, "vtu"),
    ];
    let format = draw.weighted(&formats);
    if ["msh", "vtu"].contains(&format) {
        options.switch("volume-mesh");
    }
    let name = format!("mesh.{format}");
    if draw.chance(0.3) {
        options.set("order", [2]);
    }
    if format == "inp" {
        let is_cohesive = !options.has("order") && draw.chance(0.3);
        if is_cohesive {
            options.switch("cohesive");
        }
        if domain.is_periodic && draw.chance(0.5) {
            options.switch("periodic-equations");
        }
        if case.dimension == 2 && draw.chance(0.3) {
            options.set("plane-state", [draw.one_of(&["stress", "strain"])]);
        }
        let is_loadable = options.has("box") && !domain.is_periodic;
        if is_loadable && !is_cohesive && draw.chance(0.3) {
            options.set("solver-deck", ["tension-x"]);
            case.promise.files.push("mesh.tension-x.inp".to_owned());
        }
    }
    case.promise.file("mesh", name.clone());
    // No program of ours reads the last.
    case.promise.mesh = (format != "xdmf").then(|| name.clone());
    outputs.push(name);
    options.set("output", outputs);
}
