//! Grains in the plane, filled with triangles.

use glam::DVec3;
use spade::handles::{FixedFaceHandle, FixedVertexHandle, InnerTag};
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

use super::shown::ShownNetwork;

/// Lines between grains of the plane.
#[derive(Debug)]
pub(super) struct PlaneLines {
    segments: Vec<[u32; 2]>,
    /// The grains on the left and on the right of each, going from its first end to its second.
    sides: Vec<[Option<u32>; 2]>,
    /// The ends of the lines of each grain: grain, point, segment; in order.
    ends: Vec<(u32, u32, u32)>,
}

/// A point of the plane with its number.
struct Vertex {
    position: Point2<f64>,
    point: u32,
}

impl HasPosition for Vertex {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.position
    }
}

type Delaunay = ConstrainedDelaunayTriangulation<Vertex>;

impl PlaneLines {
    pub(super) fn new(segments: &[[u32; 2]], sides: Vec<[Option<u32>; 2]>) -> Self {
        let of_segment = |(number, (ends, sides)): (u32, (&[u32; 2], &[Option<u32>; 2]))| {
            let grains: Vec<u32> = sides.iter().flatten().copied().collect();
            let ends = *ends;
            grains.into_iter().flat_map(move |grain| ends.map(|end| (grain, end, number)))
        };
        let mut ends: Vec<_> = (0..).zip(segments.iter().zip(&sides)).flat_map(of_segment).collect();
        ends.sort_unstable();
        Self { segments: segments.to_vec(), sides, ends }
    }

    /// The grains as the page draws them, each by itself: triangles between its lines (constrained Delaunay triangulation).
    pub(super) fn network(&self, points: &[DVec3]) -> ShownNetwork {
        let pieces = self.pieces(points);
        let mut grains: Vec<u32> = pieces.iter().map(|(grain, _)| *grain).collect();
        grains.dedup();
        // There are fewer pieces than triangles, which are counted in 32 bits.
        let of_piece =
            (0u32..).zip(&pieces).flat_map(|(piece, (_, own))| std::iter::repeat_n(piece, own.len()));
        let of_piece: Vec<u32> = of_piece.collect();
        let triangles: Vec<[u32; 3]> = pieces.iter().flat_map(|(_, own)| own).copied().collect();
        let outside: Vec<[Option<u32>; 2]> = pieces.iter().map(|(grain, _)| [Some(*grain), None]).collect();
        let mut network = ShownNetwork::new(points, &triangles, &of_piece, &outside);
        let places: Vec<[Option<usize>; 2]> =
            self.sides.iter().map(|sides| sides.map(|grain| grains.binary_search(&grain?).ok())).collect();
        network.set_neighbors(&places);
        // What was measured of surfaces is measured of the plane: areas, and lengths of lines.
        for facts in &mut network.facts {
            (facts.volume, facts.area) = (facts.area, 0.0);
        }
        for ([start, end], sides) in self.segments.iter().zip(&places) {
            let length = points[*start as usize].distance(points[*end as usize]);
            sides.iter().flatten().for_each(|grain| network.facts[*grain].area += length);
        }
        network
    }

    /// The triangles of each grain, in the order of the grains: of each of its pieces by itself, where the box cuts it.
    fn pieces(&self, points: &[DVec3]) -> Vec<(u32, Vec<[u32; 3]>)> {
        let vertices =
            (0..).zip(points).map(|(point, place)| Vertex { position: Point2::new(place.x, place.y), point });
        let edges = self.segments.iter().map(|ends| ends.map(|end| end as usize)).collect();
        // Lines that cross are drawn as far as they do not, and coordinates were found finite.
        let Ok(delaunay) = Delaunay::try_bulk_load_cdt(vertices.collect(), edges, |_| ()) else {
            return Vec::new();
        };
        let mut vertex_of = vec![None::<FixedVertexHandle>; points.len()];
        for vertex in delaunay.vertices() {
            vertex_of[vertex.data().point as usize] = Some(vertex.fix());
        }
        let mut beside_lines: Vec<(FixedFaceHandle<InnerTag>, Option<u32>)> = Vec::new();
        for ([start, end], [left, right]) in self.segments.iter().zip(&self.sides) {
            let (Some(from), Some(to)) = (vertex_of[*start as usize], vertex_of[*end as usize]) else {
                continue;
            };
            let Some(edge) = delaunay.get_edge_from_neighbors(from, to) else { continue };
            let faces = [(edge.face(), left), (edge.rev().face(), right)];
            beside_lines
                .extend(faces.into_iter().filter_map(|(face, grain)| Some((face.as_inner()?.fix(), *grain))));
        }
        // What no line parts belongs together.
        let mut is_found = vec![false; delaunay.num_all_faces()];
        let mut pieces = Vec::new();
        for (start, grain) in beside_lines {
            let mut piece = Vec::new();
            let mut faces = vec![start];
            while let Some(face) = faces.pop() {
                if std::mem::replace(&mut is_found[face.index()], true) {
                    continue;
                }
                let face = delaunay.face(face);
                piece.push(face.vertices().map(|vertex| vertex.data().point));
                let inside = face.adjacent_edges().into_iter().filter(|edge| !edge.is_constraint_edge());
                faces.extend(inside.filter_map(|edge| Some(edge.rev().face().as_inner()?.fix())));
            }
            if let Some(grain) = grain.filter(|_| !piece.is_empty()) {
                pieces.push((grain, piece));
            }
        }
        pieces.sort_by_key(|(grain, _)| *grain);
        pieces
    }

    /// At each vertex of a network of these lines, the mean of the numbers of the grain's lines there.
    pub(super) fn at_vertices(&self, network: &ShownNetwork, number_of: impl Fn(u32) -> f64) -> Vec<f64> {
        let number = |(grain, point): (u32, u32)| {
            let first = self.ends.partition_point(|(other, end, _)| (*other, *end) < (grain, point));
            let own =
                self.ends[first..].iter().take_while(|(other, end, _)| (*other, *end) == (grain, point));
            let (sum, count) = own
                .fold((0.0, 0.0), |(sum, count), (_, _, segment)| (sum + number_of(*segment), count + 1.0));
            sum / count
        };
        network.grain_of_vertices().zip(network.point_of.iter().copied()).map(number).collect()
    }
}
