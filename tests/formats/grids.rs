use std::fs;
use std::num::NonZeroU32;

use glam::DVec3;
use grainsmooth::vtk::{field_text, inlined};
use grainsmooth::{LabelGrid, Names, Polycrystal, Shape};
use polycrystal::{GrainId, Mesh, Side};
use voronoi::Dimension;
use vtkio::model::{Attribute, DataSet, Piece, Vtk};

use crate::workplace::{BOX, GRAINS, PLANE, SPACE, TORUS, make, write};

fn size(counts: [u32; 3]) -> [NonZeroU32; 3] {
    counts.map(|count| NonZeroU32::new(count).unwrap())
}

fn centers(grid: &LabelGrid<'_>) -> Vec<DVec3> {
    let [nx, ny, nz] = grid.size;
    let mut centers = Vec::new();
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let offset = DVec3::new(x as f64 + 0.5, y as f64 + 0.5, z as f64 + 0.5);
                centers.push(grid.origin + offset * grid.spacing);
            }
        }
    }
    centers
}

fn grain(label: &Side) -> GrainId {
    let Side::Grain(grain) = label else { panic!("a voxel of the box in no grain") };
    *grain
}

/// Flat grains are Voronoi cells: the label is the nearest seed.
#[test]
fn voxels_of_flat_grains_belong_to_the_nearest_seed() {
    for dimension in [Dimension::Two, Dimension::Three] {
        let flat = make(dimension, 0.0);
        let seeds = flat.synthesis().unwrap().cells.tessellation.seeds();
        let grid = LabelGrid::new(&flat, size([23, 17, 11]));
        assert_eq!(grid.labels().len(), 23 * 17 * if dimension == Dimension::Two { 1 } else { 11 });
        for (center, label) in centers(&grid).into_iter().zip(&grid.labels()) {
            let center = if dimension == Dimension::Two { center.with_z(0.0) } else { center };
            let distances = seeds.iter().map(|seed| seed.distance_squared(center));
            let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap().0;
            assert_eq!(grain(label).index(), nearest, "{center}");
        }
    }
}

/// In a ball or a disc, voxels with a centre beyond its surface belong to no grain.
#[test]
fn voxels_outside_of_the_domain_belong_to_no_grain() {
    let chord_error = 0.01;
    for (dimension, shape) in
        [(Dimension::Three, Shape::Sphere { chord_error }), (Dimension::Two, Shape::Disc { chord_error })]
    {
        let config = grainsmooth::Config {
            seeds: grainsmooth::SeedSource::Random { count: 20 },
            dimension,
            shape,
            relaxation: Some(polycrystal::Relaxation::Time(0.0)),
            levels: 1,
            ..grainsmooth::Config::default()
        };
        let round = grainsmooth::make_polycrystal(&config, &|_, _, _| ()).unwrap();
        let seeds = round.synthesis().unwrap().cells.tessellation.seeds();
        let grid = LabelGrid::new(&round, size([25, 21, 17]));
        let mut outside = 0;
        for (center, label) in centers(&grid).into_iter().zip(&grid.labels()) {
            let center = if dimension == Dimension::Two { center.with_z(0.0) } else { center };
            let distances = seeds.iter().map(|seed| seed.distance_squared(center));
            let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap().0;
            if round.network.domain().contains(center) {
                assert_eq!(grain(label).index(), nearest, "{center}");
            } else {
                assert_eq!(*label, Side::Exterior, "{center}");
                outside += 1;
            }
        }
        // About 1 - pi / 6 or 1 - pi / 4.
        let share = f64::from(outside) / grid.labels().len() as f64;
        assert!((0.2..0.55).contains(&share), "{share}");
    }
}

/// The solid angle that a grain's surface spans at a point is 4 pi inside and 0 outside; computed by other means than rays.
fn winding(polycrystal: &Polycrystal, grain: usize, point: DVec3) -> f64 {
    let level = polycrystal.network.finest().held();
    let Mesh::Triangles(mesh) = &level.mesh else { panic!("not in space") };
    let mut sum = 0.0;
    for (triangle, boundary) in mesh.triangles().iter().zip(&level.boundary_of) {
        let [first, second] = polycrystal.network.boundaries()[boundary.index()].sides;
        let is = |side| matches!(side, Side::Grain(id) if id.index() == grain);
        let sign = if is(first) {
            1.0
        } else if is(second) {
            -1.0
        } else {
            continue;
        };
        let [a, b, c] = triangle.map(|corner| polycrystal.points[corner as usize] - point);
        let [la, lb, lc] = [a.length(), b.length(), c.length()];
        let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        sum += sign * 2.0 * a.dot(b.cross(c)).atan2(below);
    }
    sum / (4.0 * std::f64::consts::PI)
}

#[test]
fn voxels_of_curved_grains_lie_inside_them() {
    let grid = LabelGrid::new(&SPACE, size([9, 8, 7]));
    for (center, label) in centers(&grid).into_iter().zip(&grid.labels()) {
        let inside = winding(&SPACE, grain(label).index(), center);
        assert!((inside - 1.0).abs() < 1e-6, "{center} in {label:?} winds {inside}");
    }
}

#[test]
fn labels_fill_the_volumes_of_curved_grains() {
    for (polycrystal, counts) in [(&*SPACE, [64, 48, 32]), (&*PLANE, [400, 300, 1])] {
        let grid = LabelGrid::new(polycrystal, size(counts));
        let domain = polycrystal.network.domain();
        let voxel = domain.measure() / grid.labels().len() as f64;
        let mut counts = [0; GRAINS];
        grid.labels().iter().for_each(|label| counts[grain(label).index()] += 1);
        for (count, volume) in counts.into_iter().zip(polycrystal.network.cell_volumes()) {
            // Voxels at the surface are in by chance: about the square root of their number, which is below 1000.
            assert!((f64::from(count) * voxel - volume).abs() < 60.0 * voxel, "{count} voxels for {volume}");
        }
    }
}

/// Centres exactly on corners, edges and faces: four cubes met by a grid with centres on the walls between them.
#[test]
fn centres_on_boundaries_belong_to_exactly_one_grain() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("lattice.csv");
    let mut lines = String::new();
    for (x, y, z) in (0..8).map(|k| (k & 1, k >> 1 & 1, k >> 2)) {
        lines += &format!(
            "{},{},{}\n",
            0.25 + 0.5 * f64::from(x),
            0.25 + 0.5 * f64::from(y),
            0.25 + 0.5 * f64::from(z)
        );
    }
    fs::write(&path, lines).unwrap();
    for levels in [0, 2] {
        let config = grainsmooth::Config {
            seeds: grainsmooth::SeedSource::File(path.clone()),
            relaxation: Some(polycrystal::Relaxation::Time(0.0)),
            levels,
            ..grainsmooth::Config::default()
        };
        let lattice = grainsmooth::make_polycrystal(&config, &|_, _, _| ()).unwrap();
        for count in [1, 3, 5] {
            let grid = LabelGrid::new(&lattice, size([count; 3]));
            for (center, label) in centers(&grid).into_iter().zip(&grid.labels()) {
                // A centre in the middle counts as moved towards larger coordinates.
                let upper = center.to_array().map(|x| u32::from(x >= 0.5));
                assert_eq!(grain(label).0, upper[0] + 2 * upper[1] + 4 * upper[2], "{center}");
            }
        }
    }
}

/// Without walls, a grain's voxels are those within any of its images.
#[test]
fn voxels_of_periodic_grains_lie_inside_an_image() {
    let grid = LabelGrid::new(&TORUS, size([7, 6, 5]));
    for (center, label) in centers(&grid).into_iter().zip(&grid.labels()) {
        let mut inside = 0.0;
        for translation in
            (0..27).map(|k| DVec3::new(f64::from(k % 3), f64::from(k / 3 % 3), f64::from(k / 9)) - 1.0)
        {
            inside += winding(&TORUS, grain(label).index(), center - translation * BOX);
        }
        assert!((inside - 1.0).abs() < 1e-6, "{center} in {label:?} winds {inside}");
    }
}

#[test]
fn number_of_threads_does_not_change_the_labels() {
    let with_threads = |count| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        pool.install(|| LabelGrid::new(&SPACE, size([31, 23, 17])).labels())
    };
    assert_eq!(with_threads(1), with_threads(3));
}

#[test]
fn vti_and_npy_hold_the_labels() {
    let expected = LabelGrid::new(&SPACE, SPACE.file().voxels.unwrap());
    for (names, array_name, first) in [
        (Names::Grainsmooth, "material", 0),
        (Names::Dream3d, "FeatureIds", 1),
        (Names::Neper, "MaterialId", 1),
    ] {
        let mut polycrystal = SPACE.clone();
        polycrystal.file_mut().names = names;
        let labels: Vec<i32> =
            expected.labels().iter().map(|label| grain(label).0.cast_signed() + first).collect();

        let (_folder, path) = write(&polycrystal, "labels.vti");
        let file = fs::read(path).unwrap();
        assert_eq!(
            field_text(&file, "CommandLine"),
            Some(polycrystal.provenance().command_line().into_owned())
        );
        let vtk = Vtk::parse_xml(&inlined(&file)[..]).unwrap();
        let DataSet::ImageData { origin, spacing, mut pieces, .. } = vtk.data else { panic!("no image") };
        assert_eq!((origin, spacing), ([0.0; 3], [0.1; 3]));
        let Piece::Inline(piece) = pieces.remove(0) else { panic!("no piece") };
        let [Attribute::DataArray(array)] = &piece.data.cell[..] else { panic!("not one array") };
        assert_eq!(array.name, array_name);
        assert_eq!(array.data.cast_into::<i32>().unwrap(), labels);

        let (_folder, path) = write(&polycrystal, "labels.npy");
        let file = fs::read(path).unwrap();
        assert_eq!(file[..8], *b"\x93NUMPY\x01\x00");
        let header = usize::from(u16::from_le_bytes([file[8], file[9]]));
        assert_eq!((10 + header) % 64, 0);
        let text = str::from_utf8(&file[10..10 + header]).unwrap();
        assert_eq!(text.trim_end(), "{'descr': '<i4', 'fortran_order': True, 'shape': (20, 15, 10), }");
        let numbers = file[10 + header..].as_chunks().0.iter().map(|bytes| i32::from_le_bytes(*bytes));
        let count = labels.len();
        assert!(numbers.take(count).eq(labels));
        // Behind what NumPy reads.
        assert_eq!(
            file[10 + header + 4 * count..],
            *format!("\n{}", polycrystal.synthesis().unwrap().config.to_toml()).as_bytes()
        );
    }
}

#[test]
fn ang_gives_each_grain_one_orientation() {
    let (_folder, path) = write(&PLANE, "map.ang");
    let text = fs::read_to_string(path).unwrap();
    for line in ["# GRID: SqrGrid", "# XSTEP: 0.1", "# YSTEP: 0.1", "# NCOLS_ODD: 20", "# NROWS: 15"] {
        assert!(text.lines().any(|found| found == line), "{line}");
    }
    let pixels: Vec<Vec<f64>> = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split(' ').map(|number| number.parse().unwrap()).collect())
        .collect();
    assert_eq!(pixels.len(), 20 * 15);
    let labels = LabelGrid::new(&PLANE, PLANE.file().voxels.unwrap()).labels();
    let mut angles = vec![None; GRAINS];
    for (index, pixel) in pixels.iter().enumerate() {
        let (row, column) = (index / 20, index % 20);
        assert!(
            (pixel[3] - 0.1 * column as f64).abs() < 1e-12 && (pixel[4] - 0.1 * row as f64).abs() < 1e-12
        );
        let label = grain(&labels[(14 - row) * 20 + column]).index();
        let of_grain = angles[label].get_or_insert([pixel[0], pixel[1], pixel[2]]);
        assert_eq!(*of_grain, [pixel[0], pixel[1], pixel[2]]);
    }
    let mut seen: Vec<_> = angles.iter().flatten().map(|angles| angles.map(f64::to_bits)).collect();
    seen.sort_unstable();
    seen.dedup();
    assert_eq!(seen.len(), GRAINS, "no two grains share an orientation");
}
