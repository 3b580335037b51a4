//! Pictures of grains in the plane.

use glam::DVec3;
use polycrystal::PlaneMesh;
use subzero::CurveMesh;
use tiny_skia::{
    Color as Ink, FillRule, LineCap, Paint as Brush, Path, PathBuilder, Pixmap, Stroke, Transform,
};

use super::Picture;
use super::color::Color;
use super::coloring::Paint;
use super::raster::ELEMENT_EDGE;
use crate::Polycrystal;

/// Width of a coloured line, in widths of a black one: colours of thin lines cannot be told apart.
const COLORED_LINE: f32 = 3.0;

/// Draws every grain as a filled polygon with a black outline, or lines in the colours of boundaries.
pub(super) fn draw(
    polycrystal: &Polycrystal,
    lines: &CurveMesh,
    middle: DVec3,
    paint: &Paint,
    picture: &Picture,
    pixmap: &mut Pixmap,
) {
    let outlines = outlines(polycrystal, lines);
    let shifts: Vec<DVec3> =
        polycrystal.centroids().into_iter().map(|centroid| (centroid - middle) * picture.explode).collect();
    let place = |grain: usize, point: u32| polycrystal.points[point as usize] + shifts[grain];
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for (grain, outline) in outlines.iter().enumerate() {
        for point in outline.iter().flatten() {
            low = low.min(place(grain, *point));
            high = high.max(place(grain, *point));
        }
    }
    let [width, height] = picture.size.map(|side| f64::from(side.get()));
    let inner = 1.0 - 2.0 * Picture::MARGIN;
    let scale = (inner * width / (high.x - low.x)).min(inner * height / (high.y - low.y));
    let center = low.midpoint(high);
    let stroke = Stroke {
        // Both neighbours draw the line; in an exploded view, each has its own.
        width: single(picture.line_width()),
        line_cap: LineCap::Round,
        ..Stroke::default()
    };
    let on_picture = |grain: usize, point: u32| {
        let from_middle = (place(grain, point) - center) * scale;
        [single(width / 2.0 + from_middle.x), single(height / 2.0 - from_middle.y)]
    };
    let path = |grain: usize, outline: &[Vec<u32>]| {
        closed_path(outline.iter().map(|round| round.iter().map(|point| on_picture(grain, *point))))
    };
    let paths: Vec<Option<Path>> =
        outlines.iter().enumerate().map(|(grain, outline)| path(grain, outline)).collect();
    let ink = |[r, g, b]: Color| {
        let [r, g, b] = [r, g, b].map(single);
        let mut brush = Brush { anti_alias: true, ..Brush::default() };
        brush.set_color(Ink::from_rgba(r, g, b, 1.0).unwrap_or(Ink::BLACK));
        brush
    };
    for (path, color) in paths.iter().zip(&paint.grains) {
        if let Some(path) = path {
            pixmap.fill_path(path, &ink(*color), FillRule::EvenOdd, Transform::identity(), None);
        }
    }
    if let Some(filled) = &polycrystal.plane_mesh {
        let edges =
            ElementEdges { mesh: &filled.mesh, shifts: &shifts, center, scale, size: [width, height] };
        let stroke = Stroke { width: single(ELEMENT_EDGE) * stroke.width, ..stroke.clone() };
        if let Some(path) = edges.path() {
            pixmap.stroke_path(&path, &ink([0.1; 3]), &stroke, Transform::identity(), None);
        }
    }
    // After all fills, which would cover half of a line.
    let Some(of_boundaries) = &paint.boundaries else {
        for path in paths.iter().flatten() {
            pixmap.stroke_path(path, &ink([0.1; 3]), &stroke, Transform::identity(), None);
        }
        return;
    };
    let stroke = Stroke { width: COLORED_LINE * stroke.width, ..stroke };
    let network = &polycrystal.network;
    for (ends, boundary) in lines.segments().iter().zip(&network.finest().held().boundary_of) {
        for (grain, _) in network.boundaries()[boundary.index()].signed_grains() {
            let mut path = PathBuilder::new();
            let [[x0, y0], [x1, y1]] = ends.map(|point| on_picture(grain.index(), point));
            path.move_to(x0, y0);
            path.line_to(x1, y1);
            if let Some(path) = path.finish() {
                let ink = ink(of_boundaries[boundary.index()]);
                pixmap.stroke_path(&path, &ink, &stroke, Transform::identity(), None);
            }
        }
    }
}

/// The edges of triangles that fill grains, on a picture.
struct ElementEdges<'a> {
    mesh: &'a PlaneMesh,
    /// By which grains are moved.
    shifts: &'a [DVec3],
    center: DVec3,
    scale: f64,
    size: [f64; 2],
}

impl ElementEdges<'_> {
    fn path(&self) -> Option<Path> {
        let mut path = PathBuilder::new();
        for (triangle, grain) in self.mesh.grains.iter().enumerate() {
            let places = self.mesh.corners(triangle).map(|corner| {
                let place = (corner + self.shifts[grain.index()] - self.center) * self.scale;
                [single(self.size[0] / 2.0 + place.x), single(self.size[1] / 2.0 - place.y)]
            });
            path.move_to(places[0][0], places[0][1]);
            places[1..].iter().for_each(|[x, y]| path.line_to(*x, *y));
            path.close();
        }
        path.finish()
    }
}

/// Pictures need no more digits than single precision has.
#[allow(clippy::cast_possible_truncation)]
fn single(number: f64) -> f32 {
    number as f32
}

fn closed_path(rounds: impl Iterator<Item = impl Iterator<Item = [f32; 2]>>) -> Option<Path> {
    let mut path = PathBuilder::new();
    for round in rounds {
        for (number, [x, y]) in round.enumerate() {
            if number == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
        }
        path.close();
    }
    path.finish()
}

/// The closed lines round each grain, which keep it on their left.
fn outlines(polycrystal: &Polycrystal, lines: &CurveMesh) -> Vec<Vec<Vec<u32>>> {
    let level = polycrystal.network.finest().held();
    let boundaries = polycrystal.network.boundaries();
    let mut steps: Vec<Vec<[u32; 2]>> = vec![Vec::new(); polycrystal.network.grain_count()];
    for (&[start, end], boundary) in lines.segments().iter().zip(&level.boundary_of) {
        for (grain, sign) in boundaries[boundary.index()].signed_grains() {
            steps[grain.index()].push(if sign > 0.0 { [start, end] } else { [end, start] });
        }
    }
    steps.into_iter().map(rounds).collect()
}

/// Steps joined end to start.
fn rounds(mut steps: Vec<[u32; 2]>) -> Vec<Vec<u32>> {
    steps.sort_unstable();
    let mut rounds = Vec::new();
    while let Some([start, mut end]) = steps.pop() {
        let mut round = vec![start];
        while end != start {
            round.push(end);
            let next = steps.partition_point(|[from, _]| *from < end);
            // A grain's lines close, as validation shows.
            let Some(&[from, to]) = steps.get(next) else { break };
            debug_assert_eq!(from, end, "the lines round a grain are closed");
            steps.remove(next);
            end = to;
        }
        rounds.push(round);
    }
    rounds
}
