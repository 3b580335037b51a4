//! Grains of given shapes: what is reached, what is told, what is refused.

use serde_json::Value;

use crate::workplace::{FAILED, USAGE, Workplace};

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("no number {key} in {value}"))
}

#[test]
fn shapes_are_reached_beside_exact_volumes() {
    let workplace = Workplace::new();
    for (options, asked, of_cells, finished) in [
        ("--seeds 60 --grain-shapes 2:1:1", 2.0, 1.9, 1.7),
        ("--seeds 60 --grain-shapes 1:1:2,aligned", 2.0, 1.9, 1.7),
        ("--seeds 60 --periodic x,y,z --grain-shapes 2:1:1", 2.0, 1.9, 1.7),
        ("--seeds 60 --periodic x,y --periodic-cut box --grain-shapes 2:1:1", 2.0, 1.9, 1.7),
        ("--seeds 80 --dim 2 --grain-shapes 2:1", 2.0, 1.8, 1.6),
        ("--seeds 80 --dim 2 --periodic x,y --grain-shapes 2:1", 2.0, 1.8, 1.6),
    ] {
        let run = format!("{options} -n 1 -o a.vtp --json-summary s.json --report r.html");
        let said = workplace.run(&run);
        assert!(
            said.contains("shapes      asked ") && said.contains("grains 2.00 times as long as wide"),
            "{said}"
        );
        let summary = workplace.json("s.json");
        let shapes = &summary["shapes"];
        assert_eq!(number(shapes, "ratio_asked"), asked);
        assert!(number(shapes, "ratio_of_cells") >= of_cells, "{options}: {shapes}");
        let ratio = number(shapes, "ratio");
        assert!(ratio >= finished, "{options}: {shapes}");
        let rows = summary["asked_and_reached"].as_array().unwrap();
        let row = rows.iter().find(|row| row["what"] == "length of grains over their width, median");
        assert_eq!(number(row.unwrap(), "reached"), ratio);
        let sizes = &summary["sizes"];
        assert!(number(sizes, "largest_volume_error_of_cells") < 1e-10, "{options}: {sizes}");
        assert!(number(sizes, "largest_volume_error") < 1e-10, "{options}: {sizes}");
        let page = String::from_utf8(workplace.bytes("r.html")).unwrap();
        assert!(page.contains("length of grains over their width"), "{options}");
        workplace.command("check a.vtp").assert().success();
        workplace.run("--config a.vtp -o b.vtp");
        assert!(workplace.bytes("a.vtp") == workplace.bytes("b.vtp"), "{options}");
    }
}

#[test]
fn each_grain_has_the_shape_of_its_line() {
    let workplace = Workplace::new();
    let lines: String = (0..30).map(|_| "2,1,1,90,0,0\n").collect();
    workplace.put("s.csv", format!("a,b,c,phi1,Phi,phi2\n{lines}"));
    workplace.run("--seeds 30 --grain-shapes s.csv -n 1 -o a.vtp --stats a.json");
    let grains = workplace.json("a.json")["grains"].clone();
    let grains = grains.as_array().unwrap();
    // The moment of inertia about the axis along which grains are long is the least: y, as 90 degrees about z turn x there.
    let is_long = |grain: &&Value| {
        let [x, y, z] = ["inertia_xx", "inertia_yy", "inertia_zz"].map(|key| number(grain, key));
        y < x && y < z
    };
    let count = grains.iter().filter(is_long).count();
    assert!(count >= 27, "{count} of {} grains are long along y", grains.len());
    workplace.refuses(
        "--seeds 31 --grain-shapes s.csv",
        FAILED,
        "s.csv line 1: holds 30 shapes for 31 grains; give one for each, or --seeds 30",
    );
}

#[test]
fn mistaken_shapes_are_refused() {
    let workplace = Workplace::new();
    let option = "for '--grain-shapes <SPEC|FILE>'";
    for (arguments, message) in [
        (
            "--grain-shapes long",
            format!("invalid value 'long' {option}: give lengths in proportion and whether they are along x, y, z, such as 2:1:1 or '3:1:1 aligned', or a file"),
        ),
        (
            "--grain-shapes 20:1:1",
            format!("invalid value '20:1:1' {option}: lengths are positive, and the longest at most 10 times the shortest"),
        ),
        ("--grain-shapes 2:1", "--grain-shapes takes three lengths, such as 2:1:1, without --dim 2".to_owned()),
        ("--dim 2 --grain-shapes 2:1:1", "--grain-shapes takes two lengths, such as 2:1, with --dim 2".to_owned()),
        (
            "--relax 0 --grain-shapes 2:1:1",
            "--grain-shapes makes grains of several cells, with sharp edges where these meet; leave --relax 0 out, or give --relax 0.02".to_owned(),
        ),
        (
            "--aspect-ratio 3 1 1 --grain-shapes 2:1:1",
            "the argument '--aspect-ratio <X> <Y> [Z]...' cannot be used with '--grain-shapes <SPEC|FILE>'".to_owned(),
        ),
        (
            "--grain-shapes 2:1:1 --cells-csv c.csv",
            "the argument '--grain-shapes <SPEC|FILE>' cannot be used with '--cells-csv <PATH>'".to_owned(),
        ),
    ] {
        workplace.refuses(arguments, USAGE, &message);
    }
    workplace.put("bad.csv", "a,b,c,phi1,Phi,phi2\n1,1,1,0,0,0\n1,1,0,0,0,0\n");
    for (arguments, message) in [
        (
            "--seeds 2 --grain-shapes bad.csv",
            "bad.csv line 3: lengths are positive, the longest at most 10 times the shortest, and angles finite; correct it",
        ),
        (
            "--seeds 2 --grain-shapes 2:1:1 -o a.tess",
            "a.tess: this format holds convex cells, but grains of --grain-shapes, place= or a map are not convex; choose another, such as .vtp",
        ),
    ] {
        workplace.refuses(arguments, FAILED, message);
    }
}
