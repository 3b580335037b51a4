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
        let filled = self.filled(points);
        let mut grains: Vec<u32> = filled.iter().map(|(grain, _)| *grain).collect();
        grains.sort_unstable();
        grains.dedup();
        let triangles: Vec<[u32; 3]> = filled.iter().map(|(_, corners)| *corners).collect();
        let place = |grain: u32| grains.partition_point(|other| *other < grain);
        // There are fewer grains than triangles, which are counted in 32 bits.
        let of_grain: Vec<u32> =
            filled.iter().map(|(grain, _)| u32::try_from(place(*grain)).unwrap_or(u32::MAX)).collect();
        let outside: Vec<[Option<u32>; 2]> = grains.iter().map(|grain| [Some(*grain), None]).collect();
        let mut network = ShownNetwork::new(points, &triangles, &of_grain, &outside);
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

    /// The triangles of each grain.
    fn filled(&self, points: &[DVec3]) -> Vec<(u32, [u32; 3])> {
        let vertices =
            (0..).zip(points).map(|(point, place)| Vertex { position: Point2::new(place.x, place.y), point });
        let edges = self.segments.iter().map(|ends| ends.map(|end| end as usize)).collect();
        // Lines that cross are drawn as far as they do not, and coordinates were found finite.
        let Ok(delaunay) = Delaunay::try_bulk_load_cdt(vertices.collect(), edges, |_| ()) else {
            return Vec::new();
        };
        let mut grain_of: Vec<Option<Option<u32>>> = vec![None; delaunay.num_all_faces()];
        let mut found: Vec<FixedFaceHandle<InnerTag>> = Vec::new();
        let mut vertex_of = vec![None::<FixedVertexHandle>; points.len()];
        for vertex in delaunay.vertices() {
            vertex_of[vertex.data().point as usize] = Some(vertex.fix());
        }
        for ([start, end], [left, right]) in self.segments.iter().zip(&self.sides) {
            let (Some(from), Some(to)) = (vertex_of[*start as usize], vertex_of[*end as usize]) else {
                continue;
            };
            let Some(edge) = delaunay.get_edge_from_neighbors(from, to) else { continue };
            for (face, grain) in [(edge.face(), left), (edge.rev().face(), right)] {
                if let Some(face) = face.as_inner() {
                    grain_of[face.fix().index()] = Some(*grain);
                    found.push(face.fix());
                }
            }
        }
        // What no line parts belongs together.
        while let Some(face) = found.pop() {
            let grain = grain_of[face.index()];
            for edge in delaunay.face(face).adjacent_edges() {
                let beyond = edge.rev().face().as_inner().filter(|_| !edge.is_constraint_edge());
                if let Some(beyond) = beyond.filter(|beyond| grain_of[beyond.fix().index()].is_none()) {
                    grain_of[beyond.fix().index()] = grain;
                    found.push(beyond.fix());
                }
            }
        }
        let of_grains =
            delaunay.inner_faces().filter_map(|face| Some((grain_of[face.fix().index()]??, face)));
        of_grains.map(|(grain, face)| (grain, face.vertices().map(|vertex| vertex.data().point))).collect()
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
