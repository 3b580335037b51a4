//! Seeds from formats of other programs, and from our own tables.

use crate::workplace::{FAILED, USAGE, Workplace};

#[test]
fn tess_file_gives_seeds_box_and_periods() {
    let workplace = Workplace::new();
    for arguments in ["--seeds 9 --box 2 1.5 1 --periodic x,z", "--seeds 7 --dim 2 --box 3 1", "--seeds 5"] {
        workplace.run(&format!("{arguments} -n 0 --relax 0 -o one.tess"));
        workplace.run("--seeds-file one.tess -n 0 --relax 0 -o two.tess");
        // Behind the cells stand the settings, which differ in where the seeds are from.
        let cells = |name| {
            let file = String::from_utf8(workplace.bytes(name)).unwrap();
            file.split_once("***end\n").unwrap().0.to_owned()
        };
        assert!(cells("one.tess") == cells("two.tess"), "{arguments}");
        // What ran with a .tess file runs again from its own settings.
        workplace.run("--seeds-file one.tess -n 0 --periodic none -o walls.vtp");
        workplace.run("--config walls.vtp -o again.vtp");
        assert!(workplace.bytes("walls.vtp") == workplace.bytes("again.vtp"), "{arguments}");
    }
    workplace.refuses(
        "--seeds-file one.tess --dim 2",
        USAGE,
        "--dim is not the dimension of the seeds' file; leave it out",
    );
    let tess = String::from_utf8(workplace.bytes("one.tess")).unwrap();
    workplace.put("other.tess", tess.replace("   cube\n", "   cylinder\n"));
    workplace.refuses(
        "--seeds-file other.tess",
        FAILED,
        "other.tess line 1: the domain is a cylinder; give a file whose domain is a cube (any box)",
    );
    workplace.put("cut.tess", &tess[..tess.len() / 2]);
    let cut = workplace.command("--seeds-file cut.tess").assert().code(FAILED).get_output().stderr.clone();
    let cut = String::from_utf8(cut).unwrap();
    assert!(cut.starts_with("error: cut.tess line ") && cut.ends_with("; give a complete file\n"), "{cut}");
}

/// The reader of seeds refused the program's own CSV tables.
#[test]
fn tables_of_cells_give_the_same_cells_again() {
    let workplace = Workplace::new();
    workplace.put("spheres.csv", "0.2 0.5 0.5 0.3\n0.7 0.5 0.4 0.1\n0.5 0.1 0.9 0.2\n");
    for (arguments, plane) in
        [("--seeds 12", ""), ("--seeds 8 --dim 2", "--dim 2"), ("--seeds-file spheres.csv", "")]
    {
        workplace.run(&format!("{arguments} --no-mesh --cells-json one.json --cells-csv one.csv"));
        workplace.run(&format!("--seeds-file one.json {plane} --no-mesh --cells-json two.json"));
        let cells = |name| {
            let file: serde_json::Value = serde_json::from_slice(&workplace.bytes(name)).unwrap();
            file["cells"].as_array().unwrap().clone()
        };
        assert_eq!(cells("one.json"), cells("two.json"), "{arguments}");
        workplace.run(&format!("--seeds-file one.csv {plane} --no-mesh --cells-json three.json"));
        assert_eq!(cells("one.json"), cells("three.json"), "{arguments}");
    }
}

#[test]
fn xyz_and_csv_of_the_same_spheres_are_the_same_grains() {
    let workplace = Workplace::new();
    workplace.put("a.csv", "x,y,z,radius\n0.2,0.5,0.5,0.3\n0.7,0.5,0.4,0.1\n");
    workplace.put("a.xyz", "2\nfrom elsewhere\nFe 0.2 0.5 0.5 0.3\nC 0.7 0.5 0.4 0.1\n");
    for name in ["a.csv", "a.xyz"] {
        workplace.run(&format!("--seeds-file {name} --no-mesh --cells-csv {name}.cells"));
    }
    assert!(workplace.bytes("a.csv.cells") == workplace.bytes("a.xyz.cells"));
    workplace.put("b.xyz", "2\n\nFe 0.2 0.5 0.5\nFe 0.2 0.5 0.5\n");
    workplace.refuses(
        "--seeds-file b.xyz",
        FAILED,
        "b.xyz line 3 and line 4: the same seed (0.2, 0.5, 0.5) twice; remove one of them",
    );
    workplace.put("b.json", "[[0.5, 0.5, 0.5], [2, 0.5, 0.5]]");
    workplace.refuses(
        "--seeds-file b.json",
        FAILED,
        "b.json entry 2: seed 1 at (2, 0.5, 0.5) lies outside the domain [0, 1] x [0, 1] x [0, 1]; move it inside or enlarge the domain",
    );
}
