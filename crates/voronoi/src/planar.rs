//! Cells in the plane, each cut with its seed's neighbours in the Delaunay triangulation.

use glam::DVec2;
use robust::{Coord, incircle};
use spade::handles::{DirectedEdgeHandle, FixedVertexHandle};
use spade::{DelaunayTriangulation, Point2, Triangulation};

use crate::batch::{CellBatch, in_batches};
use crate::generator::{Generator, vertex_key};
use crate::near_seeds::Cutting;
use crate::polygon::ConvexPolygon;
use crate::predicate::ExactInput;
use crate::search::Search;
use crate::{Domain, VoronoiError};

type Delaunay = DelaunayTriangulation<Point2<f64>>;
type Edge<'a> = DirectedEdgeHandle<'a, Point2<f64>, (), (), ()>;

/// Cuts all cells in parallel: with the neighbours in the Delaunay triangulation, or, if there are weights or periods, with
/// all sites that are near enough.
pub(crate) fn cut_polygons(search: &mut Search) -> Result<Vec<CellBatch>, VoronoiError> {
    let input = search.input();
    if input.weights.is_some() || input.domain.is_periodic() {
        return Ok(cut_with(search, |search, polygon, seed| search.cut(polygon, seed, &mut Vec::new())));
    }
    let delaunay = triangulate(input)?;
    Ok(cut_with(search, |search, polygon, seed| {
        let input = search.input();
        polygon.start(seed, input);
        for other in sharing_a_circle(&delaunay, seed) {
            polygon.cut_with_bisector(other, input);
        }
        Some(input)
    }))
}

fn cut_with<'a>(
    search: &mut Search<'a>,
    cut: impl for<'b> Fn(&'b Search<'a>, &mut ConvexPolygon, u32) -> Option<ExactInput<'b>> + Sync,
) -> Vec<CellBatch> {
    in_batches(search, |search, seeds| {
        let mut batch = CellBatch::new();
        let mut polygon = ConvexPolygon::new();
        for seed in seeds {
            let input = cut(search, &mut polygon, seed)?;
            push_cell(&mut batch, seed, &polygon, input);
        }
        Some(batch)
    })
}

fn triangulate(input: ExactInput) -> Result<Delaunay, VoronoiError> {
    let scale = scale_to_one(input.domain);
    let points = input.seeds.iter().map(|seed| Point2::new(seed.x * scale, seed.y * scale)).collect();
    Delaunay::bulk_load_stable(points).map_err(|error| {
        let refused = |seed: &&glam::DVec3| {
            let point = Point2::new(seed.x * scale, seed.y * scale);
            DelaunayTriangulation::<Point2<f64>>::new().insert(point).is_err()
        };
        let seed = input.seeds.iter().position(|seed| refused(&seed)).unwrap_or(0);
        VoronoiError::NotTriangulable { seed, position: input.seeds[seed], reason: error.to_string() }
    })
}

/// The power of two that brings the domain's size near 1, exactly, so that no product under- or overflows.
fn scale_to_one(domain: &Domain) -> f64 {
    let size = domain.size().max_element();
    #[expect(clippy::cast_possible_truncation, reason = "a double's exponent is below 1100")]
    let exponent = size.log2().round() as i32;
    2f64.powi(-exponent)
}

/// All seeds that share an empty circle with `seed`: its Delaunay neighbours, and those that only the triangulation's
/// arbitrary choice among equal circles separates from it. The exact cutter makes its own choice.
fn sharing_a_circle(delaunay: &Delaunay, seed: u32) -> Vec<u32> {
    let mut candidates = Vec::new();
    let vertex = delaunay.vertex(FixedVertexHandle::from_index(seed as usize));
    for edge in vertex.out_edges() {
        candidates.push(id(edge.to().fix()));
        if edge.face().is_outer() {
            continue;
        }
        let [a, b, c] = [edge.from(), edge.to(), edge.next().to()].map(|v| coordinates(v.position()));
        let mut ahead: Vec<Edge> = vec![edge.next().rev()];
        while let Some(beyond) = ahead.pop() {
            if beyond.face().is_outer() {
                continue;
            }
            let apex = beyond.next().to();
            if incircle(a, b, c, coordinates(apex.position())) == 0.0 {
                candidates.push(id(apex.fix()));
                ahead.extend([beyond.next().rev(), beyond.prev().rev()]);
            }
        }
    }
    candidates.sort_unstable();
    candidates.dedup();
    candidates
}

fn id(vertex: FixedVertexHandle) -> u32 {
    u32::try_from(vertex.index()).expect("seed ids were checked to fit")
}

fn coordinates(point: Point2<f64>) -> Coord<f64> {
    Coord { x: point.x, y: point.y }
}

fn push_cell(batch: &mut CellBatch, seed: u32, polygon: &ConvexPolygon, input: ExactInput) {
    let own: DVec2 = input.seeds[seed as usize].truncate();
    let count = polygon.corner_count();
    let mut order: Vec<_> =
        (0..count).map(|corner| (vertex_key(seed, polygon.corner_planes(corner)), corner)).collect();
    order.sort_unstable();
    let mut rank = vec![0u32; count];
    for (place, (key, corner)) in (0u32..).zip(&order) {
        rank[*corner] = place;
        batch.push_vertex(*key, (own + polygon.corner(*corner)).extend(0.0));
    }
    let first = batch.vertex_count() - count;
    let mut edges: Vec<(Generator, usize)> =
        (0..count).map(|corner| (polygon.edge_generator(corner), corner)).collect();
    edges.sort_unstable();
    for (generator, corner) in edges {
        let (from, to) = (rank[corner], rank[(corner + 1) % count]);
        batch.push_face(generator, [from, to]);
        if polygon.has_no_length(corner, input) {
            batch.coincident.push([first + from as usize, first + to as usize]);
        }
    }
    batch.finish_cell();
}
