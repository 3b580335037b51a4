//! `grainsmooth check` of elements that fill grains: what the program writes is good, and what is damaged is found.

use std::path::Path;

use glam::BVec3;
use grainsmooth::{Config, Output, PeriodicCut, VolumeFile, VolumeReport};

use crate::plane;
use crate::tetrahedra::{BOXES, coarse, filled};
use crate::workplace::{BOX, write};

fn report(path: &Path) -> VolumeReport {
    VolumeReport::new(path, &VolumeFile::read(path).unwrap().expect("elements"))
}

/// The kinds of faults of a file with some content, once each.
fn kinds(name: &str, content: &str) -> Vec<&'static str> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, content).unwrap();
    let mut kinds: Vec<&str> = report(&path).faults.iter().map(|fault| fault.kind).collect();
    kinds.dedup();
    kinds
}

#[test]
fn what_is_written_is_good() {
    let test = "what_is_written_is_good";
    let cases = BOXES.into_iter().flat_map(|case| [(case, 1), (case, 2)]);
    for ((periodic, periodic_cut), order) in cases {
        let mut config = Config { periodic, periodic_cut, ..coarse(6) };
        config.file.volume.order = Some(order);
        config.file.volume.volume_mesh = true;
        config.file.volume.periodic_equations = periodic.any();
        let Some(polycrystal) = filled(test, &config) else { return };
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.inp", "a.msh", "a.vtu", "a.bdf"] {
            let path = folder.path().join(name);
            polycrystal.write(&Output::check(&path).unwrap()).unwrap();
            let found = report(&path);
            assert!(found.good && found.faults.is_empty(), "{found}");
            assert_eq!(
                [found.grains, found.elements],
                [6, polycrystal.volume_mesh.as_ref().unwrap().tetrahedra.len()]
            );
            assert_eq!(found.order, order);
            for ((grain, volume), wanted) in (0..).zip(&found.volumes).zip(polycrystal.network.cell_volumes())
            {
                assert!(volume.0 == grain && (volume.1 / wanted - 1.0).abs() < 1e-9, "{name}: {volume:?}");
            }
            assert!(found.volume_error.unwrap().abs() < 1e-9 && (BOX.element_product() - 3.0).abs() < 1e-12);
            let has_ties = periodic.any() && name != "a.bdf";
            assert_eq!(found.tied_nodes > 0, has_ties, "{name}");
        }
    }
}

#[test]
fn triangles_that_are_written_are_good() {
    for ((periodic, periodic_cut), order) in
        BOXES.into_iter().flat_map(|case| [1, 2].map(|order| (case, order)))
    {
        let mut config = plane::coarse(periodic, periodic_cut);
        config.file.volume.order = Some(order);
        config.file.volume.volume_mesh = true;
        config.file.volume.periodic_equations = periodic.any();
        let mut polycrystal = plane::filled(&config);
        let count = polycrystal.plane_mesh.as_ref().unwrap().mesh.triangles.len();
        let folder = tempfile::tempdir().unwrap();
        let good = |polycrystal: &grainsmooth::Polycrystal, name: &str| {
            let path = folder.path().join(name);
            polycrystal.write(&Output::check(&path).unwrap()).unwrap();
            let found = report(&path);
            assert!(found.good && found.faults.is_empty(), "{found}");
            assert_eq!((found.dimension, found.grains, found.elements), (2, 12, count), "{name}");
            assert_eq!(found.order, order);
            let areas = found.volumes.iter().zip(polycrystal.network.cell_volumes());
            areas.for_each(|((_, area), wanted)| assert!((area / wanted - 1.0).abs() < 1e-9));
            assert!(found.volume_error.unwrap().abs() < 1e-9);
            let has_ties = periodic.any() && !name.ends_with("bdf");
            assert_eq!(found.tied_nodes > 0, has_ties, "{name}");
            found.cohesive_elements
        };
        for name in ["a.inp", "a.msh", "a.vtu", "a.bdf"] {
            assert_eq!(good(&polycrystal, name), 0);
        }
        if order == 1 {
            polycrystal.file_mut().volume.cohesive = true;
            assert!(good(&polycrystal, "cohesive.inp") > 20);
        }
    }
}

/// A text with one word, the first behind some others, put in place of another.
fn with(text: &str, behind: &str, from: &str, to: &str) -> String {
    let (head, tail) = text.split_once(behind).unwrap();
    assert!(tail.contains(from), "{from}");
    format!("{head}{behind}{}", tail.replacen(from, to, 1))
}

/// The line behind some text, and that text without it.
fn without_line(text: &str, behind: &str) -> (String, String) {
    let (head, tail) = text.split_once(behind).unwrap();
    let (line, rest) = tail.split_once('\n').unwrap();
    (line.to_owned(), format!("{head}{behind}{rest}"))
}

#[test]
fn what_is_damaged_is_found() {
    let test = "what_is_damaged_is_found";
    let mut config = Config { periodic: BVec3::TRUE, periodic_cut: PeriodicCut::Box, ..coarse(6) };
    config.file.volume.periodic_equations = true;
    let Some(polycrystal) = filled(test, &config) else { return };
    let (_folder, path) = write(&polycrystal, "a.inp");
    let inp = std::fs::read_to_string(path).unwrap();
    let good = |text: &str| kinds("a.inp", text);
    assert!(good(&inp).is_empty());

    let elements = "*ELEMENT, TYPE=C3D4, ELSET=ELEMENTS\n";
    let (first, without_first) = without_line(&inp, elements);
    let words: Vec<&str> = first.split(", ").collect();
    let turned = format!("{}, {}, {}, {}, {}", words[0], words[2], words[1], words[3], words[4]);
    assert_eq!(good(&inp.replacen(&first, &turned, 1))[0], "inverted");
    // An element more, among others.
    let more = format!("{elements}1000000{}\n{first}\n", &first[words[0].len()..]);
    assert!(good(&inp.replacen(&format!("{elements}{first}\n"), &more, 1)).contains(&"torn"));
    // One less, which sets name.
    let error = {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("hole.inp");
        std::fs::write(&path, &without_first).unwrap();
        VolumeFile::read(&path).unwrap_err().to_string()
    };
    assert!(error.contains("there is no element 1"), "{error}");

    // Element 1 is no part of its grain, or of two.
    let fewer = with(&inp, "*ELSET, ELSET=GRAIN_0, GENERATE\n", "1, ", "2, ");
    assert_eq!(good(&fewer)[0], "no grain");
    let (others, _) = without_line(&inp, "*ELSET, ELSET=GRAIN_1, GENERATE\n");
    let first_of_others = others.split_once(", ").unwrap().0;
    let more = with(&inp, "*ELSET, ELSET=GRAIN_1, GENERATE\n", first_of_others, "1");
    assert_eq!(good(&more)[0], "two grains");

    let (_, fewer) = without_line(&inp, "*NSET, NSET=X0\n");
    assert_eq!(good(&fewer), ["incomplete set"]);
    let (_, fewer) = without_line(&inp, "*SURFACE, TYPE=ELEMENT, NAME=BOUNDARY_0\n");
    assert_eq!(good(&fewer), ["incomplete set"]);
    let (_, fewer) = without_line(&inp, "*SURFACE, TYPE=ELEMENT, NAME=Z1\n");
    assert_eq!(good(&fewer), ["incomplete set"]);

    // The first equation's copy is tied over another number of periods.
    let (_, equations) = inp.split_once("*EQUATION\n").unwrap();
    let term = equations.lines().nth(1).unwrap();
    let last = term.rsplit_once(", ").unwrap().1;
    let wrong = with(&inp, "*EQUATION\n", &format!(", {last}\n"), ", 7.\n");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tied.inp");
    std::fs::write(&path, wrong).unwrap();
    let error = VolumeFile::read(&path).unwrap_err().to_string();
    assert!(error.contains("in the same way in all directions"), "{error}");

    // Cut off anywhere, a file is refused or found to be bad, and nothing panics.
    for share in 1..20 {
        let part = &inp[..inp.len() * share / 20];
        let path = folder.path().join("part.inp");
        std::fs::write(&path, part).unwrap();
        match VolumeFile::read(&path) {
            Err(_) => {}
            Ok(file) => {
                let found = VolumeReport::new(&path, &file.expect("tetrahedra"));
                let has_all_elements =
                    found.elements == polycrystal.volume_mesh.as_ref().unwrap().tetrahedra.len();
                assert!(!found.good || has_all_elements, "{share}");
            }
        }
    }
}

#[test]
fn damaged_files_of_other_formats_are_refused() {
    let test = "damaged_files_of_other_formats_are_refused";
    let mut config = coarse(3);
    config.file.volume.volume_mesh = true;
    let Some(polycrystal) = filled(test, &config) else { return };
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.msh", "a.bdf", "a.vtu"] {
        let path = folder.path().join(name);
        polycrystal.write(&Output::check(&path).unwrap()).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let whole = report(&path);
        for share in 1..20 {
            std::fs::write(&path, &bytes[..bytes.len() * share / 20]).unwrap();
            if let Ok(Some(file)) = VolumeFile::read(&path) {
                let found = VolumeReport::new(&path, &file);
                // What stands behind all elements may be missing.
                assert!(
                    !found.good || found.elements == whole.elements || name == "a.bdf",
                    "{name} {share}: {found}"
                );
            }
        }
    }
}

/// Cohesive elements close what is between grains with nodes of their own; where one is missing, or its nodes are others, faces lie on each other.
#[test]
fn cohesive_meshes_are_closed() {
    let test = "cohesive_meshes_are_closed";
    for (periodic, periodic_cut) in BOXES {
        let mut config = Config { periodic, periodic_cut, ..coarse(4) };
        config.file.volume.cohesive = true;
        let Some(polycrystal) = filled(test, &config) else { return };
        let (_folder, path) = write(&polycrystal, "a.inp");
        let found = report(&path);
        assert!(found.good && found.cohesive_elements > 50, "{found}");
        let inp = std::fs::read_to_string(path).unwrap();
        let (line, fewer) = without_line(&inp, "*ELEMENT, TYPE=COH3D6, ELSET=COHESIVE\n");
        let number = line.split_once(", ").unwrap().0;
        let set = format!("GENERATE\n{number}, ");
        let next: usize = number.parse().unwrap();
        let fewer = fewer.replacen(&set, &format!("GENERATE\n{}, ", next + 1), 1);
        assert!(kinds("fewer.inp", &fewer).contains(&"torn"), "{:?}", kinds("fewer.inp", &fewer));
    }
}
