//! What seed files hold, and what is said about mistakes in them.

use proptest::prelude::*;

use std::fs;

use super::*;

fn read(content: impl AsRef<[u8]>, dimension: Dimension) -> Result<Vec<FileSeed>, String> {
    read_as("seeds.csv", content, dimension)
}

fn read_as(name: &str, content: impl AsRef<[u8]>, dimension: Dimension) -> Result<Vec<FileSeed>, String> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(name);
    fs::write(&path, content).unwrap();
    let prefix = format!("{}{}", directory.path().display(), std::path::MAIN_SEPARATOR);
    let seeds = read_seed_file(&path, dimension).map_err(|error| error.to_string().replace(&prefix, ""));
    seeds.map(|FileSeeds { seeds, .. }| seeds)
}

fn seed(line: usize, x: f64, y: f64, z: f64) -> FileSeed {
    FileSeed { position: DVec3::new(x, y, z), weight: None, id: None, place: SeedPlace::Line(line) }
}

#[test]
fn files_as_users_have_them() {
    let plain = "0.1,0.2,0.3\n1e-3,-4,+5.\n";
    let expected = vec![seed(1, 0.1, 0.2, 0.3), seed(2, 1e-3, -4.0, 5.0)];
    assert_eq!(read(plain, Dimension::Three), Ok(expected.clone()));
    for separator in [", ", " ", "\t", "   ", " , "] {
        assert_eq!(read(plain.replace(',', separator), Dimension::Three), Ok(expected.clone()));
    }
    assert_eq!(read(plain.replace('\n', "\r\n"), Dimension::Three), Ok(expected.clone()));
    assert_eq!(read(plain.trim_end(), Dimension::Three), Ok(expected.clone()));
    assert_eq!(read(format!("\u{feff}{plain}"), Dimension::Three), Ok(expected));

    let dressed = "\n# from the tomogram\n X , Y, z\n\n 1, 2, 3 \n#4, 5, 6\n\t\n7, 8, 9\n\n";
    let expected = vec![seed(5, 1.0, 2.0, 3.0), seed(8, 7.0, 8.0, 9.0)];
    assert_eq!(read(dressed, Dimension::Three), Ok(expected));

    let flat = "x y\n1 2\n3 4 0\n";
    assert_eq!(read(flat, Dimension::Two), Ok(vec![seed(2, 1.0, 2.0, 0.0), seed(3, 3.0, 4.0, 0.0)]));
    assert_eq!(read("x,y,z\n1,2,0\n", Dimension::Two), Ok(vec![seed(2, 1.0, 2.0, 0.0)]));
}

#[test]
fn radii_follow_the_coordinates() {
    let weighted = |line, x, y, z, radius| FileSeed { weight: Some(radius * radius), ..seed(line, x, y, z) };
    let expected = vec![weighted(1, 1.0, 2.0, 3.0, 0.5), weighted(2, 4.0, 5.0, 6.0, 0.0)];
    assert_eq!(read("1,2,3,0.5\n4,5,6,0", Dimension::Three), Ok(expected));
    let named = "x,y,radius\n1,2,0.5\n";
    assert_eq!(read(named, Dimension::Two), Ok(vec![weighted(2, 1.0, 2.0, 0.0, 0.5)]));
    let named = "x y z radius\n1 2 0 0.5\n";
    assert_eq!(read(named, Dimension::Two), Ok(vec![weighted(2, 1.0, 2.0, 0.0, 0.5)]));
}

/// Columns of other names, in another order, quoted, or between semicolons were refused.
#[test]
fn names_choose_columns_in_any_order() {
    let weighted = |line, weight| FileSeed { weight: Some(weight), ..seed(line, 1.0, 2.0, 3.0) };
    for (content, expected) in [
        ("z,y,x\n3,2,1\n", seed(2, 1.0, 2.0, 3.0)),
        ("\"Z\";\"name\";\"y\";\"X\"\n\"3\";\"a; \"\"b\"\"\";2;1\n", seed(2, 1.0, 2.0, 3.0)),
        ("# R\n\"n\"  \"x\" \"y\" \"z\"\n\"a b\" 1 2\t3\n", seed(3, 1.0, 2.0, 3.0)),
        ("name\tx\ty\tz\tradius\n7\t1\t2\t3\t0.5\n", weighted(2, 0.25)),
        ("Diameter,x,y,z\n1,1,2,3\n", weighted(2, 0.25)),
        ("x, y, z, weight, volume\n1, 2, 3, -0.25, nan\n", weighted(2, -0.25)),
        ("x y z\n1,2,3\n", seed(2, 1.0, 2.0, 3.0)),
    ] {
        assert_eq!(read(content, Dimension::Three), Ok(vec![expected]), "{content}");
    }
    let plane = "volume,y,x\n5,2,1\n";
    assert_eq!(read(plane, Dimension::Two), Ok(vec![seed(2, 1.0, 2.0, 0.0)]));
}

#[test]
fn each_mistake_is_named_with_its_line() {
    let long = "1".repeat(50) + "o";
    let cut = format!("seeds.csv line 1: \"{}...\" is not a number; ", "1".repeat(40));
    for (content, dimension, message) in [
        (
            "1,2,3\n\n# c\n1,abc,3\n",
            3,
            "seeds.csv line 4: \"abc\" is not a number; write x, y, z as numbers such as 0.5",
        ),
        ("1,2,3\n1,,3", 3, "seeds.csv line 2: \"\" is not a number; write x, y, z as numbers such as 0.5"),
        ("1,2 3", 2, "seeds.csv line 1: \"2 3\" is not a number; write x, y as numbers such as 0.5"),
        ("1, nan, 3", 3, "seeds.csv line 1: \"nan\" is not a finite number; correct or remove the seed"),
        ("1, 2, -inf", 3, "seeds.csv line 1: \"-inf\" is not a finite number; correct or remove the seed"),
        ("1, 2, 1e999", 3, "seeds.csv line 1: \"1e999\" is not a finite number; correct or remove the seed"),
        (
            "x,y,z\n1,2\n",
            3,
            "seeds.csv line 2: 2 columns, but earlier lines have 3; write the same number on each line",
        ),
        (
            "1,2,3,4,5\n",
            3,
            "seeds.csv line 1: 5 columns; write x, y, z on each line, or name the columns in the first",
        ),
        ("1,2,3,-4\n", 3, "seeds.csv line 1: radius is -4; write 0 or more"),
        (
            "1,2,3\n1,2,3,4\n",
            3,
            "seeds.csv line 2: 4 columns, but earlier lines have 3; write the same number on each line",
        ),
        ("1\n", 2, "seeds.csv line 1: 1 columns; write x, y on each line, or name the columns in the first"),
        (
            "1,2,0.5",
            2,
            "seeds.csv line 1: z is 0.5 in a 2D run; set it to 0, run in 3D, or name the columns x, y, radius",
        ),
        ("a,b,x\n1,2,3", 3, "seeds.csv line 1: columns named \"a, b, x\"; name those of the seeds x, y, z"),
        ("x,y\n1,2,3", 3, "seeds.csv line 1: columns named \"x, y\"; name those of the seeds x, y, z"),
        ("x,y,z,X\n1,2,3,4", 3, "seeds.csv line 1: two columns named x; rename one of them"),
        (
            "x,y,z,weight,radius\n1,2,3,4,5",
            3,
            "seeds.csv line 1: columns weight and radius both say how large grains are; rename one of them",
        ),
        ("# c\n\nx,y,z,diameter\n\n1,2,3,-4", 3, "seeds.csv line 5: diameter is -4; write 0 or more"),
        (
            "x;y;z\n0,5;1;1",
            3,
            "seeds.csv line 2: \"0,5\" is not a number; write x, y, z as numbers such as 0.5",
        ),
        (
            "x,y,z,name\n1,2,3,\"a\n1,2,3",
            3,
            "seeds.csv line 2: a quote is not closed on its line; close or remove it",
        ),
        ("1,2,3\nx,y,z", 3, "seeds.csv line 2: \"x\" is not a number; write x, y, z as numbers such as 0.5"),
        ("", 3, "seeds.csv: holds no seeds; give a file with one or more"),
        ("x,y,z\n# 1,2,3\n\n", 3, "seeds.csv: holds no seeds; give a file with one or more"),
        (&format!("1,2,{long}"), 3, &format!("{cut}write x, y, z as numbers such as 0.5")),
    ] {
        let dimension = if dimension == 2 { Dimension::Two } else { Dimension::Three };
        assert_eq!(read(content, dimension), Err(message.to_owned()));
    }
}

#[test]
fn files_that_are_no_text_or_cannot_be_read() {
    let not_text = read(b"1,2,3\n\xff\xfe1\0", Dimension::Three);
    assert_eq!(not_text, Err("seeds.csv line 2: not UTF-8 text; save the file as UTF-8".to_owned()));

    let directory = tempfile::tempdir().unwrap();
    for path in [directory.path().join("missing.csv"), directory.path().to_owned()] {
        let error = read_seed_file(&path, Dimension::Three).unwrap_err().to_string();
        assert!(error.starts_with(&format!("{}: cannot be read: ", path.display())), "{error}");
        assert!(error.ends_with("; give the path of a readable file"), "{error}");
    }
}

fn entry(number: usize, x: f64, y: f64, z: f64, weight: Option<f64>) -> FileSeed {
    FileSeed { position: DVec3::new(x, y, z), weight, id: None, place: SeedPlace::Entry(number) }
}

#[test]
fn xyz_files_begin_with_a_count_and_name_elements() {
    let file = "2\nfrom a simulation\nFe 0.1 0.2 0.3\n26 4e-1 5 6\n\n";
    let expected = vec![seed(3, 0.1, 0.2, 0.3), seed(4, 0.4, 5.0, 6.0)];
    assert_eq!(read_as("s.XYZ", file, Dimension::Three), Ok(expected.clone()));
    let bare = "2\n\n0.1 0.2 0.3\n0.4 5 6";
    assert_eq!(read_as("s.xyz", bare, Dimension::Three), Ok(expected));
    let spheres = "1\n\nFe 0.1 0.2 0 0.5";
    let expected = vec![FileSeed { weight: Some(0.25), ..seed(3, 0.1, 0.2, 0.0) }];
    assert_eq!(read_as("s.xyz", spheres, Dimension::Two), Ok(expected));
    for (file, message) in [
        (
            "x y z\n1 2 3",
            "s.xyz line 1: \"x y z\" is not a number of seeds, which an .xyz file begins with; name a file without it .csv",
        ),
        (
            "1\n\nFe 1 2 3\nFe 1 2 4\n",
            "s.xyz line 4: a seed after the 1 that the first line announces; correct the number, or give one frame only",
        ),
        (
            "3\n\nFe 1 2 3\n",
            "s.xyz line 1: 3 seeds announced, but 1 found; give the complete file, or correct the number",
        ),
        (
            "1\n\n1 2\n",
            "s.xyz line 3: 2 columns; write an element, x, y, z and, if known, a radius on each line",
        ),
        ("1\n\nFe 1 2 x\n", "s.xyz line 3: \"x\" is not a number; write x, y, z as numbers such as 0.5"),
        ("0\n\n", "s.xyz: holds no seeds; give a file with one or more"),
    ] {
        assert_eq!(read_as("s.xyz", file, Dimension::Three), Err(message.to_owned()));
    }
}

#[test]
fn json_is_a_list_or_a_table_of_cells() {
    let list = "[[0.1, 0.2, 0.3], [1, 2, 3, 0.5]]";
    let expected = vec![entry(1, 0.1, 0.2, 0.3, None), entry(2, 1.0, 2.0, 3.0, Some(0.25))];
    assert_eq!(read_as("s.json", list, Dimension::Three), Ok(expected));
    let plane = r#"{"seeds": [[0.1, 0.2], {"seed": [1, 2, 0], "radius": 3}]}"#;
    let expected = vec![entry(1, 0.1, 0.2, 0.0, None), entry(2, 1.0, 2.0, 0.0, Some(9.0))];
    assert_eq!(read_as("s.json", plane, Dimension::Two), Ok(expected));
    let table = r#"{"cells": [{"id": 0, "seed": [1, 2, 3], "weight": 0.1, "volume": 3}]}"#;
    let numbered = FileSeed { id: Some(0), ..entry(1, 1.0, 2.0, 3.0, Some(0.1)) };
    assert_eq!(read_as("s.json", table, Dimension::Three), Ok(vec![numbered]));
    let unweighted = r#"{"cells": [{"seed": [1, 2, 3], "weight": 0}]}"#;
    assert_eq!(read_as("s.json", unweighted, Dimension::Three), Ok(vec![entry(1, 1.0, 2.0, 3.0, None)]));

    let remedy = "write [[x, y, z], ...], [[x, y, z, radius], ...] or what --cells-json writes";
    for (file, message) in [
        ("[[1, 2, 3],\n[1, 2", "line 2: EOF while parsing a list"),
        ("{\"seed\": 3}", "line 1: no list of seeds"),
        ("[[1, 2, 3], [1, 2]]", "entry 2: [1,2] is not a seed"),
        ("[[1, 2, \"x\"]]", "entry 1: [1,2,\"x\"] is not a seed"),
        ("[[1, 2, 1e999]]", "line 1: number out of range"),
        (
            r#"[{"seed": [1, 2, 3], "weight": "x"}]"#,
            r#"entry 1: {"seed":[1,2,3],"weight":"x"} is not a seed"#,
        ),
    ] {
        let expected = format!("s.json {message}; {remedy}");
        assert_eq!(read_as("s.json", file, Dimension::Three), Err(expected));
    }
    let negative = read_as("s.json", "[[1, 2, 3, -1]]", Dimension::Three);
    assert_eq!(negative, Err("s.json entry 1: radius is -1; write 0 or more".to_owned()));
}

/// A column of numbers was once passed over, and grains got others.
#[test]
fn ids_of_seeds_are_kept() {
    let ids = |name: &str, content: &str| {
        let seeds = read_as(name, content, Dimension::Three);
        seeds.map(|seeds| seeds.iter().map(|seed| seed.id).collect::<Vec<_>>())
    };
    let two = |first, second| Ok(vec![Some(first), Some(second)]);
    assert_eq!(ids("s.csv", "id,x,y,z\n17,1,2,3\n4.0,4,5,6\n"), two(17, 4));
    assert_eq!(ids("s.csv", "ID;x;y;z\n2147483647;1;2;3\n0;4;5;6\n"), two(2_147_483_647, 0));
    // As a table of cells has both.
    assert_eq!(ids("s.csv", "id,x,y,z,SeedId\n0,1,2,3,5\n1,4,5,6,9\n"), two(5, 9));
    let json = r#"[{"id": 3, "seed": [1, 2, 3]}, {"id": 1, "SeedId": 8, "seed": [4, 5, 6]}]"#;
    assert_eq!(ids("s.json", json), two(3, 8));
    assert_eq!(ids("s.csv", "1,2,3\n4,5,6\n"), Ok(vec![None, None]));

    let remedy = "number the seeds, or rename the column";
    for (name, content, message) in [
        (
            "s.csv",
            "id x y z\nA7 1 2 3\n",
            format!("line 2: id \"A7\" is not a whole number from 0 to 2147483647; {remedy}"),
        ),
        (
            "s.csv",
            "id x y z\n-1 1 2 3\n",
            format!("line 2: id \"-1\" is not a whole number from 0 to 2147483647; {remedy}"),
        ),
        (
            "s.csv",
            "id x y z\n2147483648 1 2 3\n",
            format!("line 2: id \"2147483648\" is not a whole number from 0 to 2147483647; {remedy}"),
        ),
        (
            "s.csv",
            "id x y z\n0.5 1 2 3\n",
            format!("line 2: id \"0.5\" is not a whole number from 0 to 2147483647; {remedy}"),
        ),
        (
            "s.csv",
            "id x y z\n3 1 2 3\n4 1 2 4\n3 1 2 5\n",
            "line 4: id 3 is also that of line 2; give each seed its own, or rename the column".to_owned(),
        ),
        (
            "s.json",
            r#"[{"id": 3, "seed": [1, 2, 3]}, [4, 5, 6]]"#,
            "entry 2: no id, but other seeds have one; give each seed its own, or none".to_owned(),
        ),
    ] {
        assert_eq!(ids(name, content), Err(format!("{name} {message}")));
    }
}

/// Files of every format that can be read.
const GOOD: [(&str, &str); 4] = [
    ("s.csv", "x,y,z,radius\n0.1,0.2,0.3,0.5\n# more\n0.5,0.25,0.125,0\n"),
    ("s.xyz", "2\nremark\nFe 0.1 0.2 0.3 0.5\nFe 0.5 0.25 0.125 0\n"),
    ("s.json", "{\"cells\": [{\"seed\": [0.1, 0.2, 0.3], \"weight\": 0.25}, [0.5, 0.25, 0.125, 0]]}\n"),
    ("s.tess", include_str!("../../../../../tests/formats/one_cell.tess")),
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn corrupt_files_are_refused_or_give_finite_seeds(
        format in 0..GOOD.len(),
        kept in any::<prop::sample::Index>(),
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4),
    ) {
        let (name, content) = GOOD[format];
        let mut content = content.as_bytes().to_vec();
        content.truncate(kept.index(content.len() + 1));
        for (place, byte) in flips {
            if !content.is_empty() {
                *place.get_mut(&mut content) = byte;
            }
        }
        for dimension in [Dimension::Two, Dimension::Three] {
            match read_as(name, &content, dimension) {
                Ok(seeds) => prop_assert!(seeds.iter().all(|seed| seed.position.is_finite())),
                Err(message) => prop_assert!(!message.contains('\n'), "{message}"),
            }
        }
    }
}

#[test]
fn good_files_are_good() {
    for (name, content) in GOOD {
        let seeds = read_as(name, content, Dimension::Three);
        assert!(seeds.as_ref().is_ok_and(|seeds| !seeds.is_empty()), "{name}: {seeds:?}");
    }
}
