//! Seeds from formats of other programs, and from our own tables.

use crate::workplace::{FAILED, USAGE, Workplace};

/// A column `id` of the user's own was once passed over.
#[test]
fn ids_of_a_seed_file_become_seed_ids() {
    let workplace = Workplace::new();
    workplace.put("seeds.csv", "id,x,y,z\n40,0.2,0.2,0.2\n7,0.8,0.3,0.4\n12,0.3,0.8,0.7\n");
    workplace.run("--seeds-file seeds.csv -n 0 --relax 0 --cells-csv cells.csv -o a.tess");
    let numbers = |table: Vec<u8>| {
        let table = String::from_utf8(table).unwrap();
        let last = table.lines().map(|line| line.rsplit(',').next().unwrap().to_owned());
        last.collect::<Vec<_>>()
    };
    assert_eq!(numbers(workplace.bytes("cells.csv")), ["SeedId", "40", "7", "12"]);
    // Tables and Neper's files lead back to the same numbers.
    for file in ["cells.csv", "a.tess"] {
        workplace.run(&format!("--seeds-file {file} --no-mesh --cells-csv again.csv"));
        assert_eq!(numbers(workplace.bytes("again.csv")), ["SeedId", "40", "7", "12"], "{file}");
    }
    workplace.put("twice.csv", "id,x,y,z\n1,0.2,0.2,0.2\n1,0.8,0.3,0.4\n");
    workplace.refuses(
        "--seeds-file twice.csv",
        FAILED,
        "twice.csv line 3: id 1 is also that of line 2; give each seed its own, or rename the column",
    );
}

/// Orientations of Neper's files were dropped without a word.
#[test]
fn orientations_that_are_passed_over_are_named() {
    let workplace = Workplace::new();
    workplace.run("--seeds 3 -n 0 --relax 0 -o a.tess");
    let tess = String::from_utf8(workplace.bytes("a.tess")).unwrap();
    let oriented = "  *ori\n   rodrigues:active\n   0.1 0.2 0.3\n   0.2 0.1 0.0\n   0.0 0.0 0.1\n  *seed\n";
    workplace.put("b.tess", tess.replace("  *seed\n", oriented));
    let line = "passed over orientations in b.tess";
    let said = workplace.run("--seeds-file b.tess -n 0 --relax 0 -o a.vtp");
    assert!(said.lines().any(|other| other == line), "{said}");
    let said = workplace.run("--seeds-file b.tess --no-mesh --cells-csv a.csv");
    assert!(said.lines().any(|other| other == line), "{said}");
    let said = workplace.run("--seeds-file a.tess -n 0 --relax 0 -o a.vtp");
    assert!(!said.contains("passed over"), "{said}");
}

#[test]
fn tess_file_gives_seeds_box_and_periods() {
    let workplace = Workplace::new();
    for arguments in [
        "--seeds 9 --seeding random --box 2 1.5 1 --periodic x,z",
        "--seeds 7 --seeding random --dim 2 --box 3 1",
        "--seeds 5 --seeding random",
    ] {
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
            let file = workplace.json(name);
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

/// The lines of a .tess file's seeds, and what stands before and behind them.
fn parts_at_seeds(tess: &str) -> [&str; 3] {
    let (before, rest) = tess.split_once("  *seed\n").unwrap();
    let (seeds, _) = rest.split_once(" **vertex").unwrap();
    [before, seeds, &rest[seeds.len()..]]
}

/// Cells that Neper had regularised or cut were made anew from their seeds, which gave other grains.
#[test]
fn tess_files_whose_cells_are_not_those_of_their_seeds_are_refused() {
    let workplace = Workplace::new();
    for (arguments, measure) in
        [("--seeds 5", "volume"), ("--seeds 5 --dim 2", "area"), ("--seeds 5 --periodic x,y,z", "volume")]
    {
        workplace.run(&format!("{arguments} -n 0 --relax 0 -o one.tess"));
        let tess = String::from_utf8(workplace.bytes("one.tess")).unwrap();
        let [before, seeds, behind] = parts_at_seeds(&tess);
        let mut swapped: Vec<&str> =
            seeds.lines().map(|line| line.trim_start().split_once(' ').unwrap().1).collect();
        swapped.swap(1, 2);
        let list: String = (1..).zip(&swapped).map(|(id, seed)| format!("   {id} {seed}\n")).collect();
        workplace.put("other.tess", format!("{before}  *seed\n{list}{behind}"));
        let message = format!(
            "other.tess entry 2: its cell has the {measure} ... ; give a file of one scale whose cells are those of its seeds, not regularized or cut"
        );
        workplace.refuses("--seeds-file other.tess", FAILED, &message);
        let outside = list.replacen(swapped[0], "-0.125 0.5 0.0 0.0", 1);
        workplace.put("other.tess", format!("{before}  *seed\n{outside}{behind}"));
        workplace.refuses(
            "--seeds-file other.tess",
            FAILED,
            "other.tess entry 1: its seed [-0.125, 0.5, 0] lies outside the domain; give a file with all seeds inside",
        );
        workplace.put("other.tess", format!("{before}{behind}"));
        workplace.refuses(
            "--seeds-file other.tess",
            FAILED,
            "other.tess line 1: the cells have no seeds; give a file with *seed, as Neper writes them",
        );
    }
}

/// Neper calls the square of its plane tessellations a cube, which was refused.
#[test]
fn the_square_of_a_plane_tess_file_may_be_called_a_cube() {
    let workplace = Workplace::new();
    workplace.run("--seeds 5 --seeding random --dim 2 --relax 0 -n 0 -o one.tess --cells-csv one.csv");
    let tess = String::from_utf8(workplace.bytes("one.tess")).unwrap();
    workplace.put("other.tess", tess.replace("   square\n", "   cube\n"));
    workplace.run("--seeds-file other.tess --no-mesh --cells-csv other.csv");
    assert!(workplace.bytes("one.csv") == workplace.bytes("other.csv"));
}

/// The radius of a weight below zero is not a number: such files could not be read.
#[test]
fn negative_weights_become_radii_of_the_same_cells() {
    let workplace = Workplace::new();
    workplace.put("seeds.csv", "x,y,z,weight\n0.2,0.5,0.5,-0.1\n0.7,0.5,0.4,-0.2\n0.5,0.1,0.9,0.05\n");
    workplace.run("--seeds-file seeds.csv --relax 0 -n 0 -o one.tess --cells-json one.json");
    workplace.run("--seeds-file one.tess --no-mesh --cells-json two.json");
    let volumes = |name| -> Vec<f64> {
        let file = workplace.json(name);
        file["cells"].as_array().unwrap().iter().map(|cell| cell["volume"].as_f64().unwrap()).collect()
    };
    let (one, two) = (volumes("one.json"), volumes("two.json"));
    assert!(
        one.len() == 3 && one.iter().zip(&two).all(|(one, two)| (one / two - 1.0).abs() < 1e-12),
        "{one:?} {two:?}"
    );
}
