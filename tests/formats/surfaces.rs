use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;

use glam::DVec3;
use grainsmooth::{OutputDirectory, OutputFormat, Polycrystal, StlEncoding};
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};
use polycrystal::Mesh;
use tempfile::TempDir;

use crate::workplace::{GRAINS, SPACE, volume, write};

fn triangles(polycrystal: &Polycrystal) -> &[[u32; 3]] {
    let Mesh::Triangles(mesh) = &polycrystal.network.finest().held().mesh else { panic!("not in space") };
    mesh.triangles()
}

/// Corners of triangles, sorted, as sets can be compared.
fn sorted(mut corners: Vec<[[u64; 3]; 3]>) -> Vec<[[u64; 3]; 3]> {
    // A triangle begins with any of its corners.
    for triangle in &mut corners {
        let first = (0..3).min_by_key(|corner| triangle[*corner]).unwrap();
        triangle.rotate_left(first);
    }
    corners.sort_unstable();
    corners
}

fn bits(point: DVec3) -> [u64; 3] {
    point.to_array().map(f64::to_bits)
}

fn expected_triangles() -> Vec<[[u64; 3]; 3]> {
    sorted(triangles(&SPACE).iter().map(|t| t.map(|corner| bits(SPACE.points[corner as usize]))).collect())
}

#[test]
fn stl_holds_every_triangle_in_single_precision() {
    let single = |point: DVec3| point.as_vec3().to_array().map(|x| u64::from(x.to_bits()));
    let expected = sorted(
        triangles(&SPACE).iter().map(|t| t.map(|corner| single(SPACE.points[corner as usize]))).collect(),
    );
    for encoding in [StlEncoding::Binary, StlEncoding::Ascii] {
        let mut polycrystal = SPACE.clone();
        polycrystal.file_mut().stl = encoding;
        let (_folder, path) = write(&polycrystal, "network.stl");
        let mut file = BufReader::new(File::open(path).unwrap());
        let read: Vec<stl_io::Triangle> =
            stl_io::create_stl_reader(&mut file).unwrap().map(Result::unwrap).collect();
        let corners = |triangle: &stl_io::Triangle| {
            triangle.vertices.map(|vertex| vertex.0.map(|x| u64::from(x.to_bits())))
        };
        assert!(sorted(read.iter().map(corners).collect()) == expected, "{encoding:?}");
        for triangle in &read {
            let [a, b, c] = triangle.vertices.map(|vertex| DVec3::from_array(vertex.0.map(f64::from)));
            let normal = DVec3::from_array(triangle.normal.0.map(f64::from));
            assert!((normal.length() - 1.0).abs() < 1e-6);
            assert!((b - a).cross(c - a).dot(normal) > 0.0);
        }
    }
}

#[test]
fn ply_holds_points_bit_for_bit_and_the_sides_of_each_triangle() {
    let (_folder, path) = write(&SPACE, "network.ply");
    let mut file = BufReader::new(File::open(path).unwrap());
    let ply = Parser::<DefaultElement>::new().read_ply(&mut file).unwrap();
    let number = |element: &DefaultElement, name: &str| match element[name] {
        Property::Double(x) => x,
        Property::Int(x) => f64::from(x),
        ref other => panic!("{name} is {other:?}"),
    };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "wholes from 0")]
    let place = |number: f64| number as usize;
    let point = |vertex: &DefaultElement| DVec3::from_array(["x", "y", "z"].map(|axis| number(vertex, axis)));
    let points: Vec<DVec3> = ply.payload["vertex"].iter().map(point).collect();
    assert_eq!(points, SPACE.points);

    let mut corners = Vec::new();
    let mut of_grains = vec![Vec::new(); GRAINS];
    for face in &ply.payload["face"] {
        let Property::ListUInt(ids) = &face["vertex_indices"] else { panic!("no list of corners") };
        let triangle = <[u32; 3]>::try_from(&ids[..]).unwrap().map(|id| points[id as usize]);
        corners.push(triangle.map(bits));
        let boundary = SPACE.network.boundaries()[place(number(face, "boundary"))];
        let sides = boundary.sides.map(|side| match side {
            polycrystal::Side::Grain(grain) => f64::from(grain.0),
            polycrystal::Side::Exterior => -1.0,
        });
        assert_eq!([number(face, "grain"), number(face, "neighbor")], sides);
        of_grains[place(sides[0])].push(triangle);
        if sides[1] >= 0.0 {
            let [a, b, c] = triangle;
            of_grains[place(sides[1])].push([a, c, b]);
        }
    }
    assert!(sorted(corners) == expected_triangles());
    for (surface, expected) in of_grains.into_iter().zip(SPACE.network.cell_volumes()) {
        assert!((volume(surface) / expected - 1.0).abs() < 1e-9);
    }
}

#[test]
fn obj_has_a_group_for_each_boundary() {
    let (_folder, path) = write(&SPACE, "network.obj");
    let (models, _) = tobj::load_obj(&path, &tobj::LoadOptions::default()).unwrap();
    assert_eq!(models.len(), SPACE.network.boundaries().len());
    let text = std::fs::read_to_string(&path).unwrap();
    let coordinates = text.lines().filter_map(|line| line.strip_prefix("v "));
    let points: Vec<DVec3> = coordinates
        .map(|line| {
            let numbers: Vec<f64> = line.split(' ').map(|number| number.parse().unwrap()).collect();
            DVec3::from_slice(&numbers)
        })
        .collect();
    assert_eq!(points, SPACE.points);

    let mut count = 0;
    for (model, boundary) in models.iter().zip(SPACE.network.boundaries()) {
        let side = |side| match side {
            polycrystal::Side::Grain(polycrystal::GrainId(grain)) => format!("grain{grain}"),
            polycrystal::Side::Exterior => "exterior".to_owned(),
        };
        let [from, to] = boundary.sides.map(side);
        assert!(model.name.ends_with(&format!(" {from} {to}")), "{}", model.name);
        count += model.mesh.indices.len() / 3;
    }
    assert_eq!(count, triangles(&SPACE).len());
}

#[test]
fn each_grain_has_a_closed_outward_file() {
    let volumes = SPACE.network.cell_volumes();
    for format in OutputFormat::of_grains() {
        let folder = TempDir::new().unwrap();
        let directory = OutputDirectory::check(folder.path().join("grains"), format).unwrap();
        grainsmooth::write_together(|files| SPACE.stage_grains(&directory, files)).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary directory is left");
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), GRAINS);
        for (grain, expected) in volumes.iter().enumerate() {
            let path = directory.path().join(format!("grain_{grain}.{}", format.extension()));
            // Reads through stl_io, ply-rs, vtkio; of STL it merges corners that are equal.
            let mesh = grainsmooth::mesh::file::read_mesh(&path).unwrap();
            let triangles = mesh.triangles().unwrap();
            let mut walks: BTreeMap<[u32; 2], i32> = BTreeMap::new();
            for [a, b, c] in &triangles {
                for [from, to] in [[a, b], [b, c], [c, a]] {
                    *walks.entry([*from.min(to), *from.max(to)]).or_default() +=
                        if from < to { 1 } else { -1 };
                }
            }
            assert!(walks.values().all(|balance| *balance == 0), "grain {grain} is closed in {format:?}");
            let at = |corner: u32| mesh.points[corner as usize];
            let error = volume(triangles.iter().map(|triangle| triangle.map(at))) / expected - 1.0;
            let precision = if format.extension() == "stl" { 1e-5 } else { 1e-9 };
            assert!(error.abs() < precision, "grain {grain} in {format:?}: {error:e}");
        }
    }
}
