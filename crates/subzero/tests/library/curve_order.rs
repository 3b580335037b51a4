//! Numbering along a curve changes ids and nothing else.

use glam::DVec3;
use proptest::prelude::*;
use subzero::{CurveOrder, Features, LoopHierarchy, LoopWeights, TriangleMesh};

const OCTAHEDRON: [[u32; 3]; 8] =
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];

fn refined(points: &[DVec3], triangles: Vec<[u32; 3]>) -> Vec<DVec3> {
    let mesh =
        TriangleMesh::new(points.len(), triangles, &Features::default()).expect("the octahedron is good");
    let mut refined = LoopHierarchy::new(mesh, 2, LoopWeights::Loop).expect("a small mesh").apply(points);
    refined.sort_by(|a, b| a.to_array().partial_cmp(&b.to_array()).expect("no point is NaN"));
    refined
}

proptest! {
    #[test]
    fn refinement_gives_the_same_points(coordinates in prop::array::uniform18(-1.0..1.0_f64)) {
        let points: Vec<DVec3> = coordinates.chunks(3).map(DVec3::from_slice).collect();
        let order = CurveOrder::new(&points, &OCTAHEDRON);
        let renumbered = refined(&order.points(&points), order.renumbered(&OCTAHEDRON));
        for (a, b) in refined(&points, OCTAHEDRON.to_vec()).iter().zip(renumbered) {
            prop_assert!(a.distance(b) < 1e-14, "{a} became {b}");
        }
    }
}

#[test]
fn neighbours_on_a_grid_come_near_each_other() {
    let (side, count) = (64_u32, 64.0 * 64.0);
    // Columns of a grid, of which every second comes later, so that all neighbours are far apart.
    let shuffled: Vec<u32> = (0..side).step_by(2).chain((1..side).step_by(2)).collect();
    let points: Vec<DVec3> = shuffled
        .iter()
        .flat_map(|&x| (0..side).map(move |y| DVec3::new(f64::from(x), f64::from(y), 0.0)))
        .collect();
    let order = CurveOrder::new(&points, &[]);
    let jumps = order.points(&points).windows(2).filter(|pair| pair[0].distance(pair[1]) > 2.0).count();
    // Of Morton's steps 3 in 4 stay in a square of 2 by 2 points; of the others 3 in 4 in one of 4 by 4, and so on.
    assert!(f64::from(u32::try_from(jumps).expect("few")) < count / 8.0, "{jumps} jumps");
}

#[test]
fn points_in_one_place_keep_their_order() {
    let order = CurveOrder::new(&[DVec3::ONE; 3], &[[2, 1, 0]]);
    assert_eq!(order.vertices(), [0, 1, 2]);
}
