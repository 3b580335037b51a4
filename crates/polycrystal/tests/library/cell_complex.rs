//! Complexes whose topology changes: what must hold after each event.

use std::collections::HashMap;

use glam::{BVec3, DVec3};
use proptest::prelude::*;
use voronoi::{CellId, Domain, FaceId, Side, Tessellation, VertexId};

use crate::complexes::{complex_counts, random_seeds};
use polycrystal::{CellComplex, ComplexEdge, OutgoingHalfEdge};

fn random_cells(domain: &Domain, count: usize, random_seed: u64) -> Tessellation {
    Tessellation::new(domain, &random_seeds(count, random_seed)).expect("valid seeds")
}

fn periodic() -> Domain {
    Domain::unit_cube().with_periods(BVec3::TRUE)
}

/// V - E + F - C, and that every cell that is left is a closed ball: each of its edges has two faces that run along it in opposite ways, and
/// V - E + F = 2.
fn checked_euler_number(tessellation: &Tessellation) -> i64 {
    let cells = (0u32..).take(tessellation.cell_count()).map(CellId);
    let left: Vec<CellId> = cells.filter(|cell| !tessellation.cell_faces(*cell).is_empty()).collect();
    for cell in left.iter().copied() {
        let mut runs: HashMap<[VertexId; 2], i32> = HashMap::new();
        let mut vertices = Vec::new();
        for face in tessellation.cell_faces(cell) {
            let mut corners = tessellation.face_corners(*face).to_vec();
            assert!(corners.len() >= 3);
            if tessellation.face_sides(*face)[0] != Side::Cell(cell) {
                corners.reverse();
            }
            for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                *runs.entry([*from, *to]).or_default() += 1;
            }
            vertices.extend(corners);
        }
        assert!(runs.values().all(|count| *count == 1), "{cell:?}");
        assert!(runs.keys().all(|[from, to]| runs.contains_key(&[*to, *from])), "{cell:?} is open");
        vertices.sort_unstable();
        vertices.dedup();
        let faces = tessellation.cell_faces(cell).len();
        assert_eq!(vertices.len() + faces, runs.len() / 2 + 2, "{cell:?}");
    }
    let counts = complex_counts(tessellation);
    let [vertices, edges, faces, cells] = [counts.vertices, counts.edges, counts.faces, left.len()]
        .map(|count| i64::try_from(count).expect("a small number"));
    vertices - edges + faces - cells
}

/// Three cells around the line x = y = 0.5, and one at each of the given heights on it.
fn around_a_line(heights: &[f64]) -> CellComplex {
    let mut seeds: Vec<DVec3> =
        [[0.7, 0.5], [0.4, 0.6732], [0.4, 0.3268]].map(|[x, y]| DVec3::new(x, y, 0.5)).into();
    seeds.extend(heights.iter().map(|z| DVec3::new(0.5, 0.5, *z)));
    let cells = Tessellation::new(&Domain::unit_cube(), &seeds).expect("valid seeds");
    CellComplex::from(&cells)
}

/// The edge on the line x = y = 0.5.
fn edge_on_line(complex: &CellComplex) -> ComplexEdge {
    let is_on_line = |point: DVec3| (point.truncate() - 0.5).length() < 1e-3;
    let mut edges = complex.edges().into_iter();
    let edge = edges.find(|edge| {
        is_on_line(complex.vertices[edge.start as usize]) && is_on_line(complex.position(edge.end))
    });
    edge.expect("three cells meet there")
}

fn neighbors(complex: &CellComplex, cell: u32) -> Vec<Side> {
    complex.tessellation().0.neighbors(CellId(cell))
}

const TRIANGLE: [DVec3; 3] =
    [DVec3::new(0.45, 0.5, 0.5), DVec3::new(0.53, 0.45, 0.5), DVec3::new(0.53, 0.55, 0.5)];

#[test]
fn an_edge_becomes_a_triangle_between_the_cells_at_its_ends() {
    let mut complex = around_a_line(&[0.05, 0.95]);
    let before = complex.tessellation().0;
    assert!(!neighbors(&complex, 3).contains(&Side::Cell(CellId(4))));
    let edge = edge_on_line(&complex);
    let face = complex.edge_to_triangle(edge, TRIANGLE).expect("the two do not meet yet");
    assert!(!complex.has_edge(edge));
    assert_eq!(complex.corners(face).len(), 3);
    assert_eq!(complex.sides(face), [3, 4].map(|cell| Side::Cell(CellId(cell))));
    let corners = complex.corners(face).iter().map(|corner| complex.position(*corner));
    assert!(corners.into_iter().all(|corner| TRIANGLE.contains(&corner)));
    let (after, _) = complex.tessellation();
    assert_eq!(checked_euler_number(&after), 1);
    assert!(neighbors(&complex, 3).contains(&Side::Cell(CellId(4))));
    // The three around still meet each other two by two, but nowhere all three.
    assert_eq!(after.face_count(), before.face_count() + 1);
    assert_eq!(after.vertices().len(), before.vertices().len() + 1);
    let volume: f64 = after.cell_measures().iter().map(|cell| cell.volume).sum();
    assert!((volume - 1.0).abs() < 1e-12, "{volume}");
}

#[test]
fn a_triangle_becomes_an_edge_again() {
    let mut complex = around_a_line(&[0.05, 0.95]);
    let before = complex.tessellation().0;
    let edge = edge_on_line(&complex);
    let ends = [complex.vertices[edge.start as usize], complex.position(edge.end)];
    let face = complex.edge_to_triangle(edge, TRIANGLE).expect("possible");
    // The edge starts at the face's first side, the lower cell.
    let places = if ends[0].z < ends[1].z { ends } else { [ends[1], ends[0]] };
    let edge = complex.triangle_to_edge(face, places).expect("its reverse");
    assert!(complex.has_edge(edge));
    assert!(complex.corners(face).is_empty());
    let (after, _) = complex.tessellation();
    assert_eq!(checked_euler_number(&after), 1);
    assert_eq!(after.face_count(), before.face_count());
    for (old, new) in before.cell_measures().iter().zip(after.cell_measures()) {
        assert!((old.volume - new.volume).abs() < 1e-12);
    }
}

#[test]
fn a_cell_comes_to_touch_a_wall() {
    let mut complex = around_a_line(&[0.95]);
    let touches_floor = |complex: &CellComplex| {
        let domain = complex.domain().clone();
        neighbors(complex, 3).into_iter().any(|side| match side {
            Side::Wall(wall) => domain.outward_normal(wall) == DVec3::NEG_Z,
            _ => false,
        })
    };
    assert!(!touches_floor(&complex));
    let edge = edge_on_line(&complex);
    let face = complex.edge_to_triangle(edge, TRIANGLE.map(|place| place.with_z(0.0))).expect("possible");
    assert!(touches_floor(&complex));
    assert_eq!(complex.sides(face)[0], Side::Cell(CellId(3)));
    assert_eq!(checked_euler_number(&complex.tessellation().0), 1);
    let corner = complex.corners(face)[0].vertex;
    assert_eq!(complex.walls_at(corner).len(), 1);
}

#[test]
fn cells_that_meet_do_not_come_to_meet_twice() {
    let mut complex = around_a_line(&[0.05, 0.95]);
    let edge = edge_on_line(&complex);
    complex.edge_to_triangle(edge, TRIANGLE).expect("possible");
    // All edges of the triangle end at the three around, which meet each other.
    for edge in complex.edges() {
        let Some(star) = complex.star_of_edge(edge) else { continue };
        let ends = star.ends.map(|side| match side {
            Side::Image(cell, _) => cell.0,
            _ => u32::MAX,
        });
        if ends.iter().all(|cell| *cell < 3) {
            assert!(complex.reconnectable_edge(edge).is_none());
        }
    }
}

#[test]
fn a_snapshot_brings_back_what_was() {
    let mut complex = CellComplex::from(&random_cells(&periodic(), 25, 7));
    let before = complex.tessellation();
    let mut count = 0;
    for edge in complex.edges() {
        let snapshot = complex.snapshot(&[edge.start, edge.end.vertex]);
        let place = middle(&complex, edge);
        count += usize::from(complex.edge_to_triangle(edge, [place; 3]).is_some());
        complex.restore(snapshot);
        assert_eq!(complex.tessellation(), before);
    }
    assert!(count > 10);
}

fn middle(complex: &CellComplex, edge: ComplexEdge) -> DVec3 {
    complex.vertices[edge.start as usize].midpoint(complex.position(edge.end))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn events_leave_a_complex_of_closed_cells(is_periodic: bool, random_seed in 1u64..1000, picks in proptest::collection::vec(0usize..10_000, 30)) {
        let domain = if is_periodic { periodic() } else { Domain::unit_cube() };
        let cells = random_cells(&domain, 25, random_seed);
        let expected = checked_euler_number(&cells);
        let mut complex = CellComplex::from(&cells);
        let mut count = 0;
        for pick in picks {
            let edges = complex.edges();
            let edge = edges[pick % edges.len()];
            let place = middle(&complex, edge);
            count += usize::from(complex.edge_to_triangle(edge, [place; 3]).is_some());
            let triangles = complex.faces_with_corners(3);
            if pick % 2 == 0 && !triangles.is_empty() {
                let face = triangles[pick % triangles.len()];
                let place = complex.position(complex.corners(face)[0]);
                count += usize::from(complex.triangle_to_edge(face, [place; 2]).is_some());
            }
            let (changed, _) = complex.tessellation();
            prop_assert_eq!(checked_euler_number(&changed), expected);
        }
        prop_assert!(count > 10);
    }
}

/// An edge of the plane that shrinks to a point and opens again is the same edge, and all cells are as they were; also where
/// they are their own neighbours.
#[test]
fn edges_of_the_plane_shrink_and_open_again() {
    for (periods, count) in
        [(BVec3::new(true, true, false), 3), (BVec3::new(true, false, false), 6), (BVec3::FALSE, 9)]
    {
        let domain = Domain::unit_square().with_periods(periods);
        let seeds: Vec<DVec3> = random_seeds(count, 4).into_iter().map(|seed| seed.with_z(0.0)).collect();
        let cells = Tessellation::new(&domain, &seeds).expect("valid seeds");
        let whole = CellComplex::from(&cells);
        for edge in whole.faces() {
            let &[start, end] = whole.corners(edge) else { panic!("an edge has two ends") };
            let walls = [start, end].map(|end| whole.walls_at(end.vertex).len());
            if start.vertex == end.vertex || walls[1] > walls[0] || (walls[1] > 0 && walls[0] < 2) {
                continue;
            }
            let at_end: Vec<(FaceId, usize)> = whole
                .outgoing_half_edges(end.vertex)
                .iter()
                .map(|half_edge| (half_edge.face, half_edge.end))
                .collect();
            let mut complex = whole.clone();
            complex.edge_to_point(edge, 0);
            let mut around = complex.outgoing_half_edges(start.vertex);
            let is_at_end = |half_edge: &OutgoingHalfEdge| at_end.contains(&(half_edge.face, half_edge.end));
            while !is_at_end(&around[0]) || is_at_end(&around[around.len() - 1]) {
                around.rotate_left(1);
            }
            around.retain(is_at_end);
            let sides = [around[0].sides[0], around[around.len() - 1].sides[1]];
            let opened = complex.point_to_edge(start.vertex, &around, sides);
            let new = complex.vertices.len() - 1;
            complex.vertices[new] =
                whole.position(end) - whole.position(start) + whole.vertices[start.vertex as usize];
            assert_eq!(complex.sides(opened), whole.sides(edge));
            let again = complex.tessellation().0;
            for cell in (0u32..).take(count).map(CellId) {
                assert_eq!(again.neighbors(cell), cells.neighbors(cell));
                assert_eq!(complex.faces_of_cell(cell).len(), whole.faces_of_cell(cell).len());
            }
            for (after, before) in again.cell_measures().iter().zip(cells.cell_measures()) {
                assert!((after.volume - before.volume).abs() < 1e-14, "{edge:?}");
            }
        }
    }
}

/// Cells give way to neighbours until a few are left, and all others stay closed balls. Where one cannot, nothing changes.
#[test]
fn cells_give_way_to_neighbors_and_leave_closed_balls() {
    for (domain, euler) in [(periodic(), 0), (Domain::unit_cube(), 1)] {
        for random_seed in 1..=4 {
            let mut complex = CellComplex::from(&random_cells(&domain, 30, random_seed));
            let mut gone = 0;
            for cell in (0..30).map(CellId) {
                let faces: Vec<FaceId> = complex.faces_of_cell(cell).collect();
                let is_gone = faces.into_iter().any(|face| {
                    let before = complex.tessellation().0;
                    let is_gone = complex.cell_to_neighbor_across(cell, face, false);
                    let after = complex.tessellation().0;
                    assert_eq!(checked_euler_number(&after), euler, "{cell:?} {face:?}");
                    if is_gone {
                        assert!(after.cell_faces(cell).is_empty());
                        let volume: f64 = after.cell_measures().iter().map(|cell| cell.volume).sum();
                        assert!((volume - 1.0).abs() < 0.2, "faces are no longer plane: {volume}");
                    } else {
                        assert_eq!(after, before);
                    }
                    is_gone
                });
                gone += usize::from(is_gone);
            }
            assert!(gone > 15, "{gone}");
        }
    }
}

/// All faces of a tetrahedron may go: what is left is one point where its four neighbours meet.
#[test]
fn a_tetrahedron_becomes_a_point_whichever_of_its_faces_goes() {
    let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    let around = corners.map(|corner| DVec3::splat(0.5) + 0.25 * DVec3::from(corner));
    let seeds: Vec<DVec3> = [DVec3::new(0.5, 0.5, 0.5)].into_iter().chain(around).collect();
    let cells = Tessellation::new(&Domain::unit_cube(), &seeds).expect("valid seeds");
    let complex = CellComplex::from(&cells);
    let faces: Vec<FaceId> = complex.faces_of_cell(CellId(0)).collect();
    assert_eq!(faces.len(), 4);
    for face in faces {
        let mut complex = complex.clone();
        assert!(complex.cell_to_neighbor_across(CellId(0), face, false));
        let (after, _) = complex.tessellation();
        assert_eq!(checked_euler_number(&after), 1);
        let is_left = |vertex: &VertexId| after.vertices()[vertex.index()].max_element() < 0.9;
        let inside = (0..u32::try_from(after.vertices().len()).expect("few")).map(VertexId).filter(is_left);
        assert_eq!(inside.filter(|vertex| after.vertices()[vertex.index()].min_element() > 0.1).count(), 1);
    }
}

/// So it is on an edge of the domain, between a cell and that same cell beyond a period.
#[test]
fn a_tetrahedron_becomes_a_point_between_a_cell_and_its_image() {
    let domain = Domain::unit_cube().with_periods(BVec3::new(true, false, false));
    let seeds = [DVec3::splat(0.5), DVec3::new(0.0, 0.9, 0.1)];
    let cells = Tessellation::power(&domain, &seeds, &[0.0, -0.5]).expect("valid seeds");
    let complex = CellComplex::from(&cells);
    let faces: Vec<FaceId> = complex.faces_of_cell(CellId(1)).collect();
    assert_eq!(faces.len(), 4);
    let inside =
        faces.into_iter().filter(|face| complex.sides(*face).iter().all(|side| side.cell().is_some()));
    let mut done = 0;
    for face in inside {
        let mut complex = complex.clone();
        assert!(complex.cell_to_neighbor_across(CellId(1), face, true));
        let (after, _) = complex.tessellation();
        // Four walls, and from both sides the face between the cell and its image; of the tetrahedron one corner is left, on an edge of the domain.
        let own: Vec<FaceId> = after.cell_faces(CellId(0)).to_vec();
        let corners = own.iter().map(|face| after.face_corners(*face).len());
        assert_eq!(corners.collect::<Vec<_>>(), [4; 6]);
        assert_eq!(after.vertices().len(), 8);
        assert!(after.cell_faces(CellId(1)).is_empty());
        done += 1;
    }
    assert_eq!(done, 2);
}
