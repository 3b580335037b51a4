//! Tensions by phases and disorientation: Herring's angles, units, floors, lines without equilibrium.

use serde_json::Value;

use crate::workplace::{FAILED, USAGE, Workplace};

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("no number {key} in {value}"))
}

fn index(value: &Value) -> usize {
    usize::try_from(value.as_i64().unwrap()).unwrap()
}

/// With less than 0.71 of the other tension, four grains of two phases in turn would rest around a point.
const PHASES: &str = "--phase a:0.5 --phase b:0.5 --tension a/b:0.9 --tension 1.1";

/// Of three boundaries at rest, each two make the angle whose cosine is that of a triangle of tensions (Herring 1951).
#[test]
fn boundaries_of_two_tensions_come_to_herrings_angles() {
    let workplace = Workplace::new();
    workplace.run(&format!(
        "{PHASES} --dim 2 --periodic x,y --seeds 40 -n 0 --stats t.json --json-summary s.json"
    ));
    let (table, summary) = (workplace.json("t.json"), workplace.json("s.json"));
    let residual = number(&summary["residual"], "rms");
    assert!(residual < 1.5e-3, "{residual}");
    let phase_of = |grain: usize| table["grains"][grain]["Phase"].as_i64().unwrap();
    let between =
        |one: usize, other: usize| -> f64 { if phase_of(one) == phase_of(other) { 1.1 } else { 0.9 } };
    let mut mixed = 0;
    for point in table["triple_points"].as_array().unwrap() {
        let sides: Vec<usize> = point["sides"].as_array().unwrap().iter().map(index).collect();
        let angles: Vec<f64> =
            point["angles"].as_array().unwrap().iter().map(|one| one.as_f64().unwrap()).collect();
        for (place, angle) in angles.iter().enumerate() {
            let [own, left, right] = [0, 1, 2].map(|step| sides[(place + step) % 3]);
            let [a, b, c] = [between(left, right), between(own, left), between(own, right)];
            let wanted = ((a * a - b * b - c * c) / (2.0 * b * c)).acos().to_degrees();
            // Half of a segment's bend at each of two boundaries.
            assert!((angle - wanted).abs() < 0.3, "{point}: {angle}, not {wanted}");
            mixed += usize::from((wanted - 120.0).abs() > 1.0);
        }
    }
    assert!(mixed > 50, "{mixed} angles other than 120 degrees");
}

#[test]
fn boundaries_of_two_tensions_come_to_rest_in_space() {
    let workplace = Workplace::new();
    let said = workplace
        .run(&format!("{PHASES} --periodic x,y,z --seeds 12 -n 2 --relax equilibrium --json-summary s.json"));
    assert!(said.contains("tensions    asked a/b:0.9, 1.1; from 0.9000 to 1.1000 between grains"), "{said}");
    let summary = workplace.json("s.json");
    let residual = number(&summary["residual"], "rms");
    assert!(residual < 0.03, "{residual}");
    assert_eq!(summary["tensions"]["without_equilibrium"], serde_json::json!([]));
}

#[test]
fn the_unit_of_tensions_changes_nothing() {
    let workplace = Workplace::new();
    for (options, law) in [
        ("--dim 2 --seeds 30 -n 0 --texture cube(8)", "read-shockley(15)"),
        ("--seeds 15 -n 1 --texture cube(8) --wall-tension 0.2", "read-shockley(15)"),
        ("--seeds 15 -n 1 --texture cube(8) --relax 0.1 --free", "read-shockley(15)"),
    ] {
        let mut expected: Option<Vec<f64>> = None;
        for unit in ["1", "1e-6", "1e6"] {
            workplace.run(&format!("{options} --tension {unit}*{law} --stats t.json"));
            let table = workplace.json("t.json");
            let grains = table["grains"].as_array().unwrap();
            let places = |grain: &Value| ["centroid_x", "centroid_y"].map(|name| number(grain, name));
            let found: Vec<f64> = grains.iter().flat_map(places).collect();
            let first = expected.get_or_insert_with(|| found.clone());
            let farthest = found.iter().zip(&*first).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(farthest < 1e-9, "{options} {unit}: {farthest}");
        }
    }
}

#[test]
fn tensions_follow_the_disorientation_down_to_a_floor() {
    let workplace = Workplace::new();
    workplace.put("law.csv", "angle,tension\n0,0\n10,0.5\n20,2\n");
    let read_shockley = |angle: f64| {
        let share = angle / 15.0;
        let tension = if share >= 1.0 { 0.8 } else { 0.8 * share * (1.0 - share.ln()) };
        tension.max(0.05 * 0.8)
    };
    let table_law = |angle: f64| {
        let tension = if angle < 10.0 { 0.05 * angle } else { (0.5 + 0.15 * (angle - 10.0)).min(2.0) };
        tension.max(0.05 * 2.0)
    };
    let laws: [(&str, &dyn Fn(f64) -> f64); 2] =
        [("0.8*read-shockley(15)", &read_shockley), ("law.csv", &table_law)];
    for (text, law) in laws {
        workplace.run(&format!(
            "--seeds 40 -n 0 --texture cube(1)*0.5+random*0.5 --tension {text} --stats t.json --json-summary s.json -o a.vtp"
        ));
        let table = workplace.json("t.json");
        let mut at_floor = 0;
        for boundary in table["boundaries"].as_array().unwrap() {
            let tension = number(boundary, "Tension");
            match boundary["Disorientation"].as_f64() {
                Some(angle) => {
                    assert!((tension - law(angle)).abs() < 1e-9, "{boundary}: not {}", law(angle));
                    at_floor += usize::from(tension == law(0.0));
                }
                None => assert_eq!(tension, 0.0, "walls"),
            }
        }
        let reached = workplace.json("s.json")["tensions"].clone();
        assert_eq!(index(&reached["at_floor"]), at_floor);
        assert!(number(&reached, "least") >= number(&reached, "floor"), "{reached}");
        assert!(String::from_utf8_lossy(&workplace.bytes("a.vtp")).contains(r#"Name="Tension""#));
    }
}

#[test]
fn lines_without_equilibrium_are_counted_and_named() {
    let workplace = Workplace::new();
    let said = workplace.run(
        "--phase a:0.5 --phase b:0.5 --tension a/a:3 --tension 1 --seeds 30 -n 0 --relax 0 --json-summary s.json --stats t.json",
    );
    let table = workplace.json("t.json");
    let phase_of = |grain: &Value| table["grains"][index(grain)]["Phase"].as_i64().unwrap();
    let has_none = |line: &&Value| {
        let sides = line["sides"].as_array().unwrap();
        let inside = sides.iter().all(|side| side.as_i64() != Some(-1));
        inside && sides.iter().filter(|side| phase_of(side) == 1).count() == 2
    };
    let wanted: Vec<Value> = table["triple_lines"]
        .as_array()
        .unwrap()
        .iter()
        .filter(has_none)
        .map(|line| line["sides"].clone())
        .collect();
    assert!(wanted.len() > 10, "{}", wanted.len());
    assert_eq!(workplace.json("s.json")["tensions"]["without_equilibrium"], Value::Array(wanted.clone()));
    assert!(
        said.contains(&format!(
            "{} without equilibrium, as one tension exceeds the sum of the others: of grains ",
            wanted.len()
        )),
        "{said}"
    );
}

#[test]
fn settings_of_a_file_repeat_its_tensions() {
    let workplace = Workplace::new();
    workplace
        .run(&format!("{PHASES} --seeds 8 -n 0 --texture random --tension b/b:2*read-shockley(20) -o a.vtp"));
    workplace.run("--config a.vtp -o b.vtp");
    assert!(workplace.bytes("a.vtp") == workplace.bytes("b.vtp"));
}

#[test]
fn tensions_that_are_mistaken() {
    let workplace = Workplace::new();
    let value =
        |text: &str, message: &str| format!("invalid value '{text}' for '--tension <[A/B:]LAW>': {message}");
    for (text, message) in [
        (
            "high",
            "'high' is not a law; give a number such as 0.8, read-shockley(15), humphreys(15), one of them times a number, or a .csv file",
        ),
        (
            "-1",
            "'-1' is not a law; give a number such as 0.8, read-shockley(15), humphreys(15), one of them times a number, or a .csv file",
        ),
        (
            "read(15)",
            "'read(15)' is not a law; give a number such as 0.8, read-shockley(15), humphreys(15), one of them times a number, or a .csv file",
        ),
        ("read-shockley(200)", "the angle 200 is not above 0, up to 180 degrees"),
    ] {
        workplace.refuses(&format!("--tension={text}"), USAGE, &value(text, message));
    }
    for (arguments, message) in [
        (
            "--tension read-shockley(15)",
            "--tension 1.0*read-shockley(15.0) depends on orientations; give the grains some, such as --texture random",
        ),
        ("--tension a/b:2", "--tension names the phase 'a'; the phases are none; give some with --phase"),
        ("--phase a:1 --tension a/c:2", "--tension names the phase 'c'; the phases are a"),
        ("--tension 1 --tension 2", "--tension has two laws for all boundaries; leave one out"),
        (
            "--phase a:0.5 --phase b:0.5 --tension a/b:1 --tension b/a:2",
            "--tension has two laws for b/a; leave one out",
        ),
        (
            "--phase a:0.5 --phase b:0.5,symmetry=hexagonal --texture random --tension read-shockley(15)",
            "--tension depends on disorientations, and phases a and b have crystals of different symmetries; give the boundaries between them a number, such as a/b:1",
        ),
        (
            "--texture random --misorientations m.csv --tension read-shockley(15)",
            "--tension 1.0*read-shockley(15.0) needs orientations before boundaries relax, and --misorientations swaps them after; leave one of them out",
        ),
        ("--mobility 2", "--mobility is for grains that grow; give --free as well"),
        (
            "--free --mobility a/b:2",
            "--mobility names the phase 'a'; the phases are none; give some with --phase",
        ),
    ] {
        workplace.refuses(arguments, USAGE, message);
    }
    // The remedy.
    workplace.run("--phase a:0.5 --phase b:0.5,symmetry=hexagonal --texture random --tension read-shockley(15) --tension a/b:1 --seeds 6 -n 0");
    for (content, message) in [
        ("angle,tension\n", "law.csv line 1: holds no angles; give an angle and a tension on each line"),
        ("angle,energy\n1,2\n", "law.csv line 1: name two columns angle and tension"),
        ("0,1\n0,2\n", "law.csv line 2: the angle 0 is not above the one before; list them in order"),
        (
            "0,1\n9,-2\n",
            "law.csv line 2: the tension -2 at 9 degrees is negative or no number, or the angle not from 0 to 180; correct it",
        ),
    ] {
        workplace.put("law.csv", content);
        workplace.refuses("--seeds 3 --texture random --tension law.csv", FAILED, message);
    }
    workplace.refuses(
        "--seeds 3 --tension 0",
        FAILED,
        "--tension gives every boundary 0; give at least one a positive number",
    );
}

/// Two grains of one kind lose or gain area by what curvature has it, times the mobility of their boundaries.
#[test]
fn mobilities_are_those_of_the_law_and_change_the_growth() {
    let workplace = Workplace::new();
    let run = |law: &str| {
        let said = workplace.run(&format!(
            "--dim 2 --periodic x,y --seeds 40 -n 1 --relax 0.02 --free --texture cube(6) {law} --stats t.json --json-summary s.json -o a.vtp"
        ));
        (said, workplace.json("t.json"), workplace.json("s.json"))
    };
    let areas = |table: &Value| -> Vec<f64> {
        table["grains"].as_array().unwrap().iter().map(|grain| number(grain, "area")).collect()
    };
    let (_, unit, _) = run("");
    let (said, grown, summary) = run("--mobility humphreys(15)");
    assert!(said.contains("mobilities  asked 1.0*humphreys(15.0); from "), "{said}");
    assert_ne!(areas(&unit), areas(&grown));
    let reached = &summary["mobilities"];
    for boundary in grown["boundaries"].as_array().unwrap() {
        let angle = number(boundary, "Disorientation") / 15.0;
        let mobility = (1.0 - (-5.0 * angle.powi(4)).exp()).max(0.05);
        assert!((number(boundary, "Mobility") - mobility).abs() < 1e-9, "{boundary}: not {mobility}");
        assert!(number(reached, "least") <= mobility + 1e-9 && mobility <= number(reached, "largest") + 1e-9);
    }
    assert!(String::from_utf8_lossy(&workplace.bytes("a.vtp")).contains(r#"Name="Mobility""#));
    // The unit is that of the mean.
    for (a, b) in areas(&grown).iter().zip(areas(&run("--mobility 1e-6*humphreys(15)").1)) {
        assert!((a / b - 1.0).abs() < 1e-9, "{a} and {b}");
    }
    for (a, b) in areas(&unit).iter().zip(areas(&run("--mobility 7").1)) {
        assert!((a / b - 1.0).abs() < 1e-9, "{a} and {b}");
    }
}

/// Either fell back without a word of why, or named a grain to merge.
#[test]
fn what_has_no_equilibrium_is_named_where_nothing_comes_to_rest() {
    let workplace = Workplace::new();
    let wet = "--phase a:0.5 --phase b:0.5 --tension 1 --tension a/a:8 -n 1";
    let said = workplace.run(&format!("{wet} --seeds 200 --rng-seed 2"));
    assert!(
        said.contains("led to no valid network, because lines without equilibrium never come to rest"),
        "{said}"
    );
    std::fs::remove_file(workplace.path("grains.vtp")).unwrap();
    workplace.refuses(
        &format!("{wet} --seeds 30 --rng-seed 13 --dim 2"),
        FAILED,
        "the network is invalid:  ... ; at 15 triple points one tension exceeds the sum of the others, as of grains 1-2-13, and nothing is at rest there: give tensions of which none is above twice the least",
    );
}
