use std::f64::consts::PI;
use std::fs;

use glam::DVec3;
use grainsmooth::polycrystal::certify;
use grainsmooth::{Config, LabelledFile, SeedSource, Shape, Tess, make_polycrystal, read_tess};
use proptest::prelude::*;
use voronoi::{CellId, Dimension, Wall};

use crate::workplace::{BOX, GRAINS, PLANE, SPACE, TORUS, write};

fn written(dimension: Dimension) -> String {
    let polycrystal = if dimension == Dimension::Two { &*PLANE } else { &*SPACE };
    let (_folder, path) = write(polycrystal, "cells.tess");
    fs::read_to_string(path).unwrap()
}

#[test]
fn written_cells_come_back_bit_for_bit() {
    for (dimension, polycrystal) in [(Dimension::Two, &*PLANE), (Dimension::Three, &*SPACE)] {
        let tess = read_tess(&written(dimension)).unwrap();
        assert_eq!(tess, Tess::new(&polycrystal.synthesis().unwrap().cells));
        assert_eq!(tess.seeds.len(), GRAINS);
        assert_eq!(tess.domain.upper, if dimension == Dimension::Two { BOX.with_z(0.0) } else { BOX });
    }
}

#[test]
fn periodic_cells_come_back_with_their_copies() {
    let (_folder, path) = write(&TORUS, "cells.tess");
    let tess = read_tess(&fs::read_to_string(path).unwrap()).unwrap();
    assert_eq!(tess, Tess::new(&TORUS.synthesis().unwrap().cells));
    let periodicity = tess.periodicity.unwrap();
    assert_eq!((periodicity.axes, periodicity.lengths), ([true; 3], BOX));
    assert_eq!(periodicity.seeds.len(), 26 * GRAINS);
    assert!(tess.domain.walls.iter().all(Vec::is_empty));
    let moved = |vertex: u32, translation: [i32; 3]| {
        tess.vertices[vertex as usize] + DVec3::from_array(translation.map(f64::from)) * BOX
    };
    for copy in &periodicity.vertices {
        let error = moved(copy.primary.index, copy.translation) - tess.vertices[copy.secondary as usize];
        assert!(error.length() < 1e-12);
    }
    for copy in &periodicity.edges {
        let mut ends = tess.edges[copy.primary.index as usize];
        if copy.primary.is_reversed {
            ends.reverse();
        }
        for (end, of_copy) in ends.into_iter().zip(tess.edges[copy.secondary as usize]) {
            assert!((moved(end, copy.translation) - tess.vertices[of_copy as usize]).length() < 1e-12);
        }
    }
    for copy in &periodicity.faces {
        let [face, of_copy] = [copy.primary.index, copy.secondary].map(|face| &tess.faces[face as usize]);
        let sign = if copy.primary.is_reversed { -1.0 } else { 1.0 };
        let [normal, of_copy_s] = [face, of_copy].map(|face| DVec3::from_slice(&face.plane[1..]));
        assert!((normal * sign - of_copy_s).length() < 1e-9);
        assert_eq!(face.vertices.len(), of_copy.vertices.len());
    }
    assert!(!periodicity.faces.is_empty() && !periodicity.edges.is_empty());
}

#[test]
fn cells_are_networks_with_their_volumes() {
    for polycrystal in [&*PLANE, &*SPACE, &*TORUS] {
        let (_folder, path) = write(polycrystal, "cells.tess");
        let volumes = read_tess(&fs::read_to_string(&path).unwrap()).unwrap().cell_volumes();
        let file = LabelledFile::read(&path).unwrap();
        let certificate = certify(&file.surface(), &file.expected());
        assert!(certificate.is_good(), "{}", certificate.faults);
        assert_eq!(certificate.grain_volumes.len(), GRAINS);
        for ((grain, volume), of_cell) in certificate.grain_volumes.iter().zip(volumes) {
            assert!((volume / of_cell - 1.0).abs() < 1e-11, "{grain:?}: {volume}, {of_cell}");
        }
    }
}

/// Neper may list the edges of a face from another corner on than its corners, or the other way round.
#[test]
fn edges_of_a_face_are_found_by_their_ends() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cell.tess");
    for edges in ["4 9 -8 -12 4", "4 -12 4 9 -8", "4 12 8 -9 -4"] {
        fs::write(&path, ONE_CELL.replacen("4 9 -8 -12 4", edges, 1)).unwrap();
        let file = LabelledFile::read(&path).unwrap();
        let certificate = certify(&file.surface(), &file.expected());
        assert!(certificate.is_good(), "{edges}: {}", certificate.faults);
        assert!((certificate.grain_volumes[0].1 - 1.0).abs() < 1e-12);
    }
    fs::write(&path, ONE_CELL.replacen("4 9 -8 -12 4", "4 9 -8 -12 5", 1)).unwrap();
    let error = LabelledFile::read(&path).unwrap_err().to_string();
    assert!(error.contains("no edge of face 1 joins its vertices 4 and 1"), "{error}");
}

/// Polyhedra are closed by their faces, planes hold the corners, and signed volumes are those of the cells.
#[test]
fn polyhedra_are_closed_and_outward() {
    let tess = read_tess(&written(Dimension::Three)).unwrap();
    let at = |vertex: u32| tess.vertices[vertex as usize];
    for face in &tess.faces {
        let [d, a, b, c] = face.plane;
        let normal = DVec3::new(a, b, c);
        assert!((normal.length() - 1.0).abs() < 1e-12);
        for (k, &corner) in face.vertices.iter().enumerate() {
            assert!((normal.dot(at(corner)) - d).abs() < 1e-12);
            let next = face.vertices[(k + 1) % face.vertices.len()];
            let ends = tess.edges[face.edges[k].index as usize];
            let ends = if face.edges[k].is_reversed { [ends[1], ends[0]] } else { ends };
            assert_eq!(ends, [corner, next]);
        }
    }
    for (cell, faces) in (0..).zip(&tess.polyhedra) {
        let mut volume = 0.0;
        for part in faces {
            let face = &tess.faces[part.index as usize];
            let sign = if part.is_reversed { -1.0 } else { 1.0 };
            let corners: Vec<DVec3> = face.vertices.iter().map(|&vertex| at(vertex)).collect();
            for pair in corners[1..].windows(2) {
                volume += sign * corners[0].dot(pair[0].cross(pair[1])) / 6.0;
            }
        }
        let expected =
            SPACE.synthesis().unwrap().cells.tessellation.cell_measures()[CellId(cell).index()].volume;
        assert!((volume / expected - 1.0).abs() < 1e-12);
    }
}

#[test]
fn volumes_of_a_file_are_those_of_its_cells() {
    for polycrystal in [&*SPACE, &*PLANE, &*TORUS] {
        let (_folder, path) = write(polycrystal, "cells.tess");
        let tess = read_tess(&fs::read_to_string(path).unwrap()).unwrap();
        let measures = polycrystal.synthesis().unwrap().cells.tessellation.cell_measures();
        assert_eq!(tess.cell_volumes().len(), GRAINS);
        for (volume, measure) in tess.cell_volumes().into_iter().zip(measures) {
            assert!((volume / measure.volume - 1.0).abs() < 1e-12);
        }
    }
}

/// What Neper says of its domain: each part of the box with all that lies on it.
#[test]
fn domain_names_what_lies_on_it() {
    let text = written(Dimension::Three);
    let tess = read_tess(&text).unwrap();
    let mut area = [0.0; 6];
    for wall in Wall::ALL {
        for &face in &tess.domain.walls[wall.index()] {
            let corners: Vec<DVec3> = tess.faces[face as usize]
                .vertices
                .iter()
                .map(|&vertex| tess.vertices[vertex as usize])
                .collect();
            for corner in &corners {
                let coordinate = if wall.is_upper() { BOX[wall.axis()] } else { 0.0 };
                assert_eq!(corner[wall.axis()], coordinate);
            }
            for pair in corners[1..].windows(2) {
                area[wall.index()] += (pair[0] - corners[0]).cross(pair[1] - corners[0]).length() / 2.0;
            }
        }
    }
    for (area, expected) in area.into_iter().zip([1.5, 1.5, 2.0, 2.0, 3.0, 3.0]) {
        assert!((area - expected).abs() < 1e-12);
    }
    let domain = text.split("**domain").nth(1).unwrap();
    for label in ["x0y0z0", "x1y1z1", "x0y1", "y1z0", "x1z1"] {
        assert_eq!(domain.split_whitespace().filter(|word| *word == label).count(), 1, "{label}");
    }
    // Every corner of the box is exactly one vertex.
    assert_eq!(domain.split("*edge").next().unwrap().matches("\n      1 ").count(), 8);
}

/// A domain that is no box is a polyhedron, each wall of it with all that lies on it.
#[test]
fn polyhedra_and_polygons_come_back_with_their_walls() {
    let chord_error = 0.01;
    for (dimension, shape, expected) in [
        (Dimension::Three, Shape::Sphere { chord_error }, PI),
        (Dimension::Three, Shape::Cylinder { chord_error }, 1.5 * PI),
        (Dimension::Two, Shape::Disc { chord_error }, PI),
    ] {
        let config = Config {
            seeds: SeedSource::Random { count: 30 },
            dimension,
            shape,
            levels: 0,
            ..Config::default()
        };
        let round = make_polycrystal(&config, &|_, _, _| ()).unwrap();
        let (_folder, path) = write(&round, "cells.tess");
        let text = fs::read_to_string(path).unwrap();
        let tess = read_tess(&text).unwrap();
        let mut made = Tess::new(&round.synthesis().unwrap().cells);
        // Corners are rounded.
        assert!(tess.domain.lower.distance(made.domain.lower) < 1e-14);
        assert!(tess.domain.upper.distance(made.domain.upper) < 1e-14);
        (made.domain.lower, made.domain.upper) = (tess.domain.lower, tess.domain.upper);
        assert!(tess == made);

        // All walls together are the surface of the body.
        let place = |vertex: u32| tess.vertices[vertex as usize];
        let area = |part: u32| match dimension {
            Dimension::Two => {
                let [start, end] = tess.edges[part as usize];
                place(start).distance(place(end))
            }
            Dimension::Three => {
                let corners = &tess.faces[part as usize].vertices;
                let from_first = |corner: &u32| place(*corner) - place(corners[0]);
                let triangles = corners[1..].windows(2);
                triangles.map(|pair| from_first(&pair[0]).cross(from_first(&pair[1])).length() / 2.0).sum()
            }
        };
        let surface: f64 = tess.domain.walls.iter().flatten().map(|part| area(*part)).sum();
        assert!((surface / expected - 1.0).abs() < 0.03, "{surface} for {expected}");

        let section = text.split("**domain").nth(1).unwrap();
        let count = |part: &str| -> usize {
            let after = section.split(&format!("*{part}\n")).nth(1).unwrap();
            after.split_whitespace().next().unwrap().parse().unwrap()
        };
        let parts = tess.domain.walls.iter().filter(|parts| !parts.is_empty()).count();
        match dimension {
            Dimension::Two => assert_eq!((count("vertex"), count("edge")), (parts, parts)),
            Dimension::Three => {
                assert_eq!(count("face"), parts);
                assert_eq!(count("vertex") + count("face"), count("edge") + 2);
            }
        }
    }
}

/// A cube of one cell as Neper 3.4 would write it, with orientations, a scale and no types of the domain's edges.
const ONE_CELL: &str = include_str!("one_cell.tess");

#[test]
fn file_in_neper_s_own_layout() {
    let tess = read_tess(ONE_CELL).unwrap();
    assert_eq!(
        (tess.vertices.len(), tess.edges.len(), tess.faces.len(), tess.polyhedra.len()),
        (8, 12, 6, 1)
    );
    assert_eq!(tess.seeds[0].position, DVec3::new(0.25, 0.5, 0.75));
    assert_eq!(tess.seeds[0].radius, 0.125);
    assert_eq!((tess.domain.lower, tess.domain.upper), (DVec3::ZERO, DVec3::ONE));
    assert_eq!(tess.domain.walls, [[0], [1], [2], [3], [4], [5]]);
}

#[test]
fn mistakes_are_named_with_their_line() {
    for (from, to, message) in [
        ("***tess", "***tesr", "line 1: \"***tesr\" where ***tess must stand"),
        (
            "   3.4",
            "   9.9",
            "line 3: version \"9.9\" is none of 3.3, 3.4, 3.5; write the file again with another Neper",
        ),
        ("3 standard", "4 standard", "line 5: \"4\" is not a dimension; write 2 or 3"),
        ("0.25 0.5", "nan 0.5", "line 11: \"nan\" is not an x coordinate"),
        ("  1 1 2 0\n", "  1 1 9 0\n", "line 28: vertex 9 does not exist, there are 8"),
        (
            " **polyhedron\n  1\n   1 6",
            " **polyhedron\n  1\n   2 6",
            "line 67: polyhedron 2 where 1 must stand",
        ),
        ("     x1\n", "     x2\n", "line 94: \"x2\" is not a wall of a cube"),
        ("***end\n", "", "line 121: the file ends before ***end; give a complete file"),
    ] {
        assert!(ONE_CELL.contains(from), "{from}");
        let error = read_tess(&ONE_CELL.replacen(from, to, 1)).unwrap_err();
        let said = error.to_string();
        assert!(said.split_once(": ").unwrap().1 == message.split_once(": ").unwrap().1, "{said}");
        assert!(said.starts_with("line "), "{said}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// A file cut short is refused, however it is cut.
    #[test]
    fn truncated_files_are_refused(part in 0..1000_usize) {
        let text = ONE_CELL.trim_end();
        prop_assert!(read_tess(&text[..part * text.len() / 1000]).is_err());
    }

    /// A word replaced by another makes an error or another tessellation, and never a panic or endless memory.
    #[test]
    fn corrupted_files_do_no_harm(
        place in 0..10_000_usize,
        word in prop::sample::select(vec!["-1", "0", "7", "99999999999", "1e999", "x", "**face", "*seed", "***end", ""]),
    ) {
        for text in [ONE_CELL, &written(Dimension::Two)] {
            let words: Vec<&str> = text.split_inclusive(char::is_whitespace).collect();
            let place = place % words.len();
            let corrupted = [&words[..place].concat(), word, " ", &words[place + 1..].concat()].concat();
            if let Ok(tess) = read_tess(&corrupted) {
                let all = tess.faces.iter().flat_map(|face| &face.vertices);
                prop_assert!(all.into_iter().all(|&vertex| (vertex as usize) < tess.vertices.len()));
            }
        }
    }
}
