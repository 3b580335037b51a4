//! Networks of other programs, damaged.

use glam::BVec3;
use grainsmooth::{Config, LabelledFile, Output, make_polycrystal};
use polycrystal::certify;
use voronoi::Dimension;

use crate::maps::refused_in_200_ways;
use crate::workplace::config;

/// Grains in the plane as a table, and as MATLAB writes them: two squares.
const TABLE: &str = "grain,x,y\n3,0,0\n3,1,0\n3,1,1\n3,0,1\n4,1,0\n4,2,0\n4,2,1\n4,1,1\n";
const POLYGONS: &str = r#"{"V": [[0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [2, 1]], "poly": [[1, 2, 3, 4, 1], [2, 5, 6, 3, 2]], "id": [3, 4]}"#;

#[test]
fn damaged_networks_of_others_are_read_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let read = |path: &std::path::Path| {
        let file = LabelledFile::read(path)?;
        // What is read is judged, good or not, and never ends the program.
        certify(&file.surface(), &file.expected());
        Ok(())
    };
    for (name, periodic) in
        [("space.fe", BVec3::FALSE), ("torus.fe", BVec3::TRUE), ("space.stl", BVec3::FALSE)]
    {
        // As few points as possible: each file is read 200 times.
        let config = Config { levels: 0, periodic, ..config(Dimension::Three, 0.0) };
        let polycrystal = make_polycrystal(&config, &|_, _, _| ()).unwrap();
        let path = folder.path().join(name);
        polycrystal.write(&Output::check(&path).unwrap()).unwrap();
        let refused = refused_in_200_ways(&path, read);
        assert!(refused > 20, "{name}: {refused}");
    }
    let dump = include_str!("../data/strings.dmp");
    for (name, text) in [("grains.csv", TABLE), ("grains.json", POLYGONS), ("strings.dmp", dump)] {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        assert!(read(&path).is_ok());
        let refused = refused_in_200_ways(&path, read);
        assert!(refused > 20, "{name}: {refused}");
    }
}
