//! Foams whose least area is known.

use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_3, PI};

use crate::common::{Labelled, cube};
use glam::{BVec3, DVec3, IVec3};
use polycrystal::{
    BoundaryId, GrainId, Junctions, Network, Relaxation, Side, SpaceMeasures, dihedral_angles,
    measure_network, relax, validate,
};
use voronoi::Domain;
use voronoi::volumes::PowerDiagram;

fn measures(network: &Network, points: &[DVec3]) -> SpaceMeasures {
    measure_network(network, points).in_space().expect("surfaces")
}

/// Weaire and Phelan 1994: cells of two kinds with an area of 5.288 V^(2/3), less than Kelvin's, of which half is that of the cell.
#[test]
fn the_foam_of_weaire_and_phelan_has_its_area() {
    let seeds = [
        [0.0, 0.0, 0.0],
        [0.5, 0.5, 0.5],
        [0.0, 0.5, 0.25],
        [0.0, 0.5, 0.75],
        [0.25, 0.0, 0.5],
        [0.75, 0.0, 0.5],
        [0.5, 0.25, 0.0],
        [0.5, 0.75, 0.0],
    ]
    .map(|place| DVec3::from_array(place) + 0.1);
    let domain = Domain::unit_cube().with_periods(BVec3::TRUE);
    let cells = PowerDiagram::with_volumes(&domain, &seeds, &[0.125; 8]).expect("volumes that fill the cube");
    let (network, flat) = Network::new(cells.tessellation(), Junctions::Crease, 3).expect("a small network");
    let mut faces: Vec<usize> =
        measures(&network, &network.subdivide(&flat)).grains.iter().map(|grain| grain.face_count).collect();
    faces.sort_unstable();
    assert_eq!(faces, [12, 12, 14, 14, 14, 14, 14, 14]);
    let relaxed = relax(&network, &flat, &Relaxation::Equilibrium, |_, _| ()).expect("relaxes");
    let points = relaxed.finest_points(&network);
    validate(&network, &points).expect("valid");

    let areas: f64 = measures(&network, &points).grains.iter().map(|grain| grain.area).sum();
    // Each boundary is two grains', of which it counts half for each.
    let area = areas / 2.0 / 8.0 / 0.125f64.powf(2.0 / 3.0);
    assert!((area / 2.644 - 1.0).abs() < 5e-4, "{area}");
    let angles = dihedral_angles(&network, network.finest(), &points).expect("lines");
    assert!(angles.standard_deviation < 2.0, "{angles:?}");
}

/// Two soap bubbles that share a wall are parts of three spheres that meet at 120 degrees (Hutchings, Morgan, Ritore and Ros 2002), whose pressures
/// differ by twice the tension over the radius.
#[test]
fn a_double_bubble_has_the_area_and_the_angles_of_theory() {
    // The wall is a cap of this half angle over a circle of this radius, and bulges into the larger bubble.
    let (half_angle, ring) = (20f64.to_radians(), 0.15);
    let cap = |half_angle: f64| {
        let radius: f64 = ring / half_angle.sin();
        let height = 1.0 - half_angle.cos();
        (2.0 * PI * radius.powi(2) * height, PI / 3.0 * radius.powi(3) * height.powi(2) * (3.0 - height))
    };
    let wall = cap(half_angle);
    let [small, large] = [2.0 * FRAC_PI_3 - half_angle, 2.0 * FRAC_PI_3 + half_angle].map(cap);
    let volumes = [small.1 + wall.1, large.1 - wall.1];
    let area = small.0 + large.0 + wall.0;

    let (network, start) = two_boxes(volumes).network(3).expect("a network");
    let network = network.with_cell_volumes(vec![1.0 - volumes[0] - volumes[1], volumes[0], volumes[1]]);
    let relaxed = relax(&network, &start, &Relaxation::Equilibrium, |_, _| ()).expect("relaxes");
    let points = relaxed.finest_points(&network);
    validate(&network, &points).expect("valid");
    let measures = measures(&network, &points);
    let found: f64 = measures
        .boundaries
        .iter()
        .filter(|boundary| !boundary.sides.contains(&Side::Exterior))
        .map(|boundary| boundary.area)
        .sum();
    assert!((found / area - 1.0).abs() < 2e-3, "{found}, not {area}");
    let angles = dihedral_angles(&network, network.finest(), &points).expect("a line");
    assert!((angles.mean - 120.0).abs() < 0.5 && angles.standard_deviation < 2.5, "{angles:?}");
    // Mean curvature, of each boundary half of the pressure difference.
    let curvature = |one: u32, other: u32| {
        let sides = [Side::Grain(GrainId(one)), Side::Grain(GrainId(other))];
        let boundary = measures
            .boundaries
            .iter()
            .find(|boundary| sides.iter().all(|side| boundary.sides.contains(side)));
        let boundary = boundary.expect("they meet");
        if boundary.sides[0] == sides[0] { boundary.mean_curvature } else { -boundary.mean_curvature }
    };
    let balance = curvature(1, 0) + curvature(0, 2) + curvature(2, 1);
    assert!(balance.abs() < 0.05 * curvature(1, 0).abs(), "{balance}");
    let radius = ring / (2.0 * FRAC_PI_3 - half_angle).sin();
    assert!((curvature(1, 0).abs() * radius - 1.0).abs() < 0.05, "{}", curvature(1, 0) * radius);
}

/// A box on another, grains 1 and 2 of such volumes, in the middle of grain 0, which fills the unit cube.
fn two_boxes(volumes: [f64; 2]) -> Labelled {
    const ACROSS: i32 = 6;
    const UP: [i32; 2] = [4, 5];
    let width = 0.35;
    let heights = volumes.map(|volume| volume / (width * width));
    let label = |cell: IVec3| {
        let is_across = (0..ACROSS).contains(&cell.x) && (0..ACROSS).contains(&cell.y);
        match cell.z {
            z if is_across && (0..UP[0]).contains(&z) => 1,
            z if is_across && (UP[0]..UP[0] + UP[1]).contains(&z) => 2,
            _ => 0,
        }
    };
    let place = |node: IVec3| {
        let z = if node.z <= UP[0] {
            heights[0] * f64::from(node.z) / f64::from(UP[0])
        } else {
            heights[0] + heights[1] * f64::from(node.z - UP[0]) / f64::from(UP[1])
        };
        let across = |k: i32| 0.5 + width * (f64::from(k) / f64::from(ACROSS) - 0.5);
        DVec3::new(across(node.x), across(node.y), 0.5 - 0.5 * (heights[0] + heights[1]) + z)
    };
    let (mut points, mut triangles) = cube();
    let [outside, lower, upper] = [0, 1, 2].map(|grain| Side::Grain(GrainId(grain)));
    let sides = vec![[outside, Side::Exterior], [lower, outside], [upper, outside], [lower, upper]];
    let mut boundary_of = vec![BoundaryId(0); triangles.len()];
    let mut numbers: HashMap<IVec3, u32> = HashMap::new();
    for z in -1..UP[0] + UP[1] {
        for y in -1..ACROSS {
            for x in -1..ACROSS {
                for (axis, across) in [IVec3::X, IVec3::Y, IVec3::Z].into_iter().enumerate() {
                    let cell = IVec3::new(x, y, z);
                    let labels = [label(cell), label(cell + across)];
                    let boundary = match labels {
                        [1, 0] | [0, 1] => 1,
                        [2, 0] | [0, 2] => 2,
                        [1, 2] => 3,
                        _ => continue,
                    };
                    let along = [[IVec3::Y, IVec3::Z], [IVec3::Z, IVec3::X], [IVec3::X, IVec3::Y]][axis];
                    let corner = cell + across;
                    let mut number = |node: IVec3| {
                        *numbers.entry(node).or_insert_with(|| {
                            points.push(place(node));
                            u32::try_from(points.len() - 1).expect("few points")
                        })
                    };
                    let square = [corner, corner + along[0], corner + along[0] + along[1], corner + along[1]];
                    let [a, b, c, d] = square.map(&mut number);
                    let is_reversed = labels[0] == 0;
                    for [a, b, c] in [[a, b, c], [a, c, d]] {
                        triangles.push(if is_reversed { [a, c, b] } else { [a, b, c] });
                        boundary_of.push(BoundaryId(boundary));
                    }
                }
            }
        }
    }
    Labelled { points, triangles, boundary_of, sides }
}
