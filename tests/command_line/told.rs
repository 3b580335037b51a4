//! What runs and their summaries tell of the network: changes of topology, angles and thin triangles.

use serde_json::Value;

use crate::front::{printed, text};
use crate::workplace::Workplace;

/// Random grains come together and part on the way to equilibrium; both summaries tell, and the topology is sound.
#[test]
fn summaries_tell_of_changes_of_topology() {
    let workplace = Workplace::new();
    let said = workplace
        .run("--seeds 24 --seeding random -n 2 --relax equilibrium -o a.vtp --json-summary run.json");
    let run = workplace.json("run.json");
    let number = |key: &str| run["equilibrium"][key].as_f64().unwrap();
    let changes = |key: &str| run["topology_changes"][key].as_f64().unwrap();
    let events = ["lines_to_boundaries", "boundaries_to_lines", "neighbor_switches"].map(changes);
    assert!(events.iter().sum::<f64>() > 0.0, "{said}");
    let [to_triangles, to_edges, switched] = events;
    let line = format!(
        "topology    {to_triangles} edge-to-triangle flips, {to_edges} triangle-to-edge flips, {switched} neighbor switches"
    );
    assert!(said.lines().any(|said| said == line), "{line}\nis not in\n{said}");
    let flagged = format!(
        "equilibrium {} triple lines flagged (short, of four boundaries, or not at rest); largest residual of others {:.4}",
        number("flagged_lines"),
        number("largest_residual")
    );
    assert!(said.lines().any(|said| said == flagged), "{flagged}\nis not in\n{said}");
    let residual = |key: &str| run["residual"][key].as_f64().unwrap();
    let line = format!(
        "residual    {:.4} rms of the tensions at triple lines, largest {:.4}; 0 at rest",
        residual("rms"),
        residual("largest")
    );
    assert!(said.lines().any(|said| said == line), "{line}\nis not in\n{said}");
    assert!(residual("rms") < 0.02 && residual("largest") >= number("largest_residual"), "{said}");
    assert!(run["attempts"].is_array(), "{run}");
    let spread = |key: &str| run[key]["standard_deviation"].as_f64().unwrap();
    assert!(spread("angles_after") < 0.25 * spread("angles_before"), "{said}");
    printed(&workplace, "check a.vtp");
    let said = workplace.run("--seeds 24 -n 1 --relax equilibrium --regularize 0 -o b.vtp");
    assert!(said.contains("\ntopology    kept: "), "{said}");
    // In a given time grains switch neighbours, but nobody asks for rest.
    let said = workplace.run("--seeds 24 --seeding random -n 0 -o b.vtp --json-summary run.json");
    let run = workplace.json("run.json");
    assert!(run["equilibrium"].is_null());
    assert!(run["topology_changes"]["boundaries_to_lines"].as_f64().unwrap() > 0.0, "{said}");
    let count = |counts: &str, of: &str| run["topology"][counts][of].as_u64().unwrap_or(0);
    assert!(count("points_by_grains", "4") > 80 && count("points_by_grains", "5") < 4, "{said}");
    assert_eq!(count("lines_by_boundaries", "4"), 0, "{said}");
    let said = workplace.run("--seeds 24 -n 0 --regularize 0.05 -o b.vtp --json-summary run.json");
    let run = workplace.json("run.json");
    assert!(run["topology_changes"].is_null(), "{said}");
}

/// In 2D, too: in equilibrium only the bend of segments is between angles and 120 degrees.
#[test]
fn summaries_tell_of_changes_of_topology_in_the_plane() {
    let workplace = Workplace::new();
    let plane = "--dim 2 --relax equilibrium -o a.vtp --json-summary run.json";
    for seeds in [
        "--seeds 60 --seeding random",
        "--seeds 60 --periodic x,y --seeding random",
        "--seeds 30 --domain disc --seeding random",
        "--lattice square 4",
    ] {
        let said = workplace.run(&format!("{seeds} {plane}"));
        let run = workplace.json("run.json");
        let number = |key: &str| run["equilibrium"][key].as_f64().unwrap();
        let changes = |key: &str| run["topology_changes"][key].as_f64().unwrap();
        let events = ["neighbor_switches", "lines_to_boundaries", "boundaries_to_lines"].map(changes);
        assert!(events.iter().sum::<f64>() > 0.0, "{said}");
        let [switched, split, collapsed] = events;
        let line = format!(
            "topology    {switched} neighbor switches (T1), {split} points split, {collapsed} edges collapsed"
        );
        assert!(said.lines().any(|said| said == line), "{line}\nis not in\n{said}");
        assert!(number("largest_residual") < 2.3e-3 && number("flagged_lines") == 0.0, "{said}");
        let after = &run["angles_after"];
        assert!((after["mean"].as_f64().unwrap() - 120.0).abs() < 1e-9, "{said}");
        assert!(after["standard_deviation"].as_f64().unwrap() < 0.25, "{said}");
        assert!(run["largest_relative_volume_error"].as_f64().unwrap() < 1e-10, "{said}");
        printed(&workplace, "check a.vtp");
    }
}

/// The summary once left the angles out where there were none before relaxation: four grains meet everywhere in a square lattice.
#[test]
fn summaries_tell_the_angles_that_lattices_come_to() {
    let workplace = Workplace::new();
    let said = workplace.run("--dim 2 --lattice square 4 --relax equilibrium -o a.vtp");
    let line = said.lines().find(|line| line.starts_with("angles      120.00 +- 0.")).expect(&said);
    assert!(line.ends_with(" degrees after relaxation; before, no line had exactly three grains"), "{line}");
}

/// One of these lost its volume where the topology changed, and left angles 136 degrees off.
#[test]
fn changes_of_topology_leave_grains_their_volumes() {
    let workplace = Workplace::new();
    let seeds = "--seeds 12 -n 1 --rng-seed 3 --relax equilibrium";
    workplace.run(&format!("{seeds} -o a.vtp --json-summary run.json --stats stats.json"));
    let [run, stats]: [Value; 2] = ["run.json", "stats.json"].map(|name| workplace.json(name));
    // At a wall one boundary stays far from square to it: lines there are flagged.
    let lines = stats["triple_lines"].as_array().unwrap().iter();
    let is_inside = |line: &&Value| !line["sides"].as_array().unwrap().contains(&Value::from(-1));
    let largest = lines.filter(is_inside).filter_map(|line| line["residual"].as_f64()).fold(0.0, f64::max);
    assert!(largest > 0.0 && largest < 0.07, "{largest}");
    assert!(run["residual"]["largest"].as_f64().unwrap() < 0.1 || run["equilibrium"]["flagged_lines"] != 0);
    printed(&workplace, "check a.vtp");
}

#[test]
fn runs_and_checks_tell_how_thin_triangles_are() {
    let workplace = Workplace::new();
    let said = workplace.run("--seeds 20 -n 1 -o a.vtp --json-summary run.json");
    let run = workplace.json("run.json");
    let [least, percentile] =
        ["least", "first_percentile"].map(|key| run["triangle_angles"][key].as_f64().unwrap());
    assert!(least >= 1.5 && least < percentile && percentile < 60.0, "{said}");
    assert_eq!(run["triangle_angles"]["thin"], 0);
    let line = format!(
        "triangles   one in a hundred has an angle below {percentile:.1} degrees; the least is {least:.2}"
    );
    assert!(said.lines().any(|said| said == line), "{line}\nis not in\n{said}");
    let checked = text(&workplace, "check a.vtp");
    assert!(checked.lines().any(|said| said.trim_start() == line), "{line}\nis not in\n{checked}");
    // Flat boundaries are as thin as cells have them.
    let said = workplace.run("--seeds 100 -n 0 --relax 0 -o flat.vtp --json-summary run.json");
    let run = workplace.json("run.json");
    let thin = run["triangle_angles"]["thin"].as_u64().unwrap();
    assert!(thin > 0 && said.contains(&format!(", {thin} are below 1.5")), "{said}");
    workplace.run("--dim 2 --seeds 20 -o b.vtp --json-summary run.json");
    let run = workplace.json("run.json");
    assert!(run["triangle_angles"].is_null());
}
