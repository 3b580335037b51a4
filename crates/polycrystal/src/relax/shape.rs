//! How a network's control points and a cell complex that changes belong together.

use std::collections::HashMap;

use glam::DVec3;
use voronoi::{CellComplex, ComplexEdge, Corner, FaceId, Side, Tessellation};

use crate::{Network, folded_edges};

/// Cosine of the largest bend of a boundary that keeps its bulges (75 degrees): later levels must not reach 90.
const LARGEST_BEND: f64 = 0.26;

/// Turns of looking for folds; flattening one boundary may fold another, as they share lines.
const TURNS: usize = 3;

/// How far triple lines and boundaries bulge: from the mean of the vertices around to their one control point.
///
/// A line is known by the boundaries that meet there, so that it keeps its shape while its ends change.
#[derive(Debug, Default)]
pub(super) struct Shape {
    lines: HashMap<Vec<FaceId>, DVec3>,
    faces: HashMap<FaceId, DVec3>,
}

/// The cells of a complex and which control points of their network, with fans, belong to what.
pub(super) struct ControlPoints {
    pub(super) cells: Tessellation,
    /// Of each vertex of the cells, that of the complex.
    corners: Vec<Corner>,
    /// Control points of lines and faces, each with the vertices around it. Copies in a periodic domain are left out.
    lines: Vec<(Vec<FaceId>, usize, Vec<usize>)>,
    faces: Vec<(FaceId, usize, Vec<usize>)>,
    /// The lines round each face.
    lines_of_face: Vec<Vec<usize>>,
}

impl ControlPoints {
    pub(super) fn new(complex: &CellComplex) -> Self {
        let (cells, corners) = complex.tessellation();
        let edges = cells.edges();
        let lines = (corners.len()..).zip(&edges.ends).map(|(point, ends)| {
            let line = ComplexEdge::between(ends.map(|end| corners[end.index()]));
            (complex.faces_of_edge(line), point, ends.map(voronoi::VertexId::index).to_vec())
        });
        let lines = lines.collect();
        let first_face = corners.len() + edges.ends.len();
        let mut corner_edges = edges.of_corner.iter();
        let (mut faces, mut lines_of_face) = (Vec::new(), Vec::new());
        for ((face, number), point) in cells.faces().zip(complex.faces()).zip(first_face..) {
            let around = cells.face_corners(face);
            let lines = corner_edges.by_ref().take(around.len()).map(|edge| *edge as usize);
            lines_of_face.push(lines.collect());
            faces.push((number, point, around.iter().map(|vertex| vertex.index()).collect()));
        }
        Self { cells, corners, lines, faces, lines_of_face }
    }

    /// How far the lines of the cells bulge, in the order of their edges.
    pub(super) fn bulges_of_lines(&self, shape: &Shape) -> Vec<DVec3> {
        self.lines.iter().map(|(line, ..)| shape.lines.get(line).copied().unwrap_or_default()).collect()
    }

    /// Puts the vertices of the complex where the control points are.
    pub(super) fn place_vertices(&self, complex: &mut CellComplex, points: &[DVec3]) {
        for (point, corner) in points.iter().zip(&self.corners) {
            let shift = corner.shift.vector(self.cells.domain());
            complex.vertices[corner.vertex as usize] = *point - shift;
        }
    }

    /// The shape of lines and boundaries. Walls have none: what is inside them follows their rims.
    pub(super) fn shape(&self, complex: &CellComplex, points: &[DVec3]) -> Shape {
        let bulge = |point: usize, around: &[usize]| points[point] - mean(points, around);
        let lines = self.lines.iter().map(|(line, point, ends)| (line.clone(), bulge(*point, ends)));
        let is_free = |face: FaceId| !matches!(complex.sides(face)[1], Side::Wall(_));
        let faces = self.faces.iter().filter(|(face, ..)| is_free(*face));
        Shape {
            lines: lines.collect(),
            faces: faces.map(|(face, point, around)| (*face, bulge(*point, around))).collect(),
        }
    }

    /// The control points of a network with fans, where the complex has its vertices, in the given shape.
    ///
    /// What would be folded is flat.
    pub(super) fn points(&self, complex: &CellComplex, network: &Network, shape: &Shape) -> Vec<DVec3> {
        let mut points: Vec<DVec3> = self.corners.iter().map(|corner| complex.position(*corner)).collect();
        for (line, _, ends) in &self.lines {
            let bulge = shape.lines.get(line).copied().unwrap_or_default();
            points.push(mean(&points, ends) + bulge);
        }
        for (face, _, around) in &self.faces {
            let bulge = shape.faces.get(face).copied().unwrap_or_default();
            points.push(mean(&points, around) + bulge);
        }
        // Centres of copied faces come last, and are placed in the end.
        points.resize(network.control_mesh().vertex_count(), DVec3::ZERO);
        for _ in 0..TURNS {
            let finest = network.finest();
            let folds = folded_edges(finest, &network.subdivide(&points), LARGEST_BEND);
            let boundaries = folds.into_iter().flatten().map(|element| finest.boundary_of[element as usize]);
            let mut folded: Vec<usize> = boundaries
                .map(|boundary| {
                    let twin = network.boundaries()[boundary.index()].twin;
                    twin.map_or(boundary.index(), |twin| twin.boundary.index().min(boundary.index()))
                })
                .collect();
            folded.sort_unstable();
            folded.dedup();
            for face in &folded {
                for line in &self.lines_of_face[*face] {
                    let (_, point, ends) = &self.lines[*line];
                    points[*point] = mean(&points, ends);
                }
                let (_, point, around) = &self.faces[*face];
                points[*point] = mean(&points, around);
            }
            if folded.is_empty() {
                break;
            }
        }
        network.control_mesh().copies.place(network.domain(), &mut points);
        points
    }
}

impl Shape {
    /// How far a boundary bulges.
    pub(super) fn bulge(&self, face: FaceId) -> DVec3 {
        self.faces.get(&face).copied().unwrap_or_default()
    }
}

/// Some sides, each once and sorted; a cell and its images are one.
pub(super) fn distinct(sides: impl IntoIterator<Item = Side>) -> Vec<Side> {
    let sides = sides.into_iter().map(|side| match side {
        Side::Image(cell, _) => Side::Cell(cell),
        Side::Cell(_) | Side::Wall(_) => side,
    });
    let mut sides: Vec<Side> = sides.collect();
    sides.sort_unstable();
    sides.dedup();
    sides
}

fn mean(points: &[DVec3], some: &[usize]) -> DVec3 {
    some.iter().map(|point| points[*point]).sum::<DVec3>() / some.len() as f64
}
