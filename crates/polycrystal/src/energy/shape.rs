//! How triple lines and boundaries of a cell complex bulge.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;
use voronoi::{FaceId, PeriodicVertex, Side, Tessellation};

use crate::energy::fans::Fans;
use crate::mesh::fold::LARGEST_FOLD;
use crate::{CellComplex, ComplexEdge};

/// How far triple lines and boundaries bulge: from the mean of the vertices around to their one control point.
///
/// Walls do not: what is inside them follows their rims.
#[derive(Debug, Default, Clone)]
pub(crate) struct Shape {
    /// Sorted by line.
    lines: Vec<(ComplexEdge, DVec3)>,
    /// By the number of the boundary.
    faces: Vec<DVec3>,
}

impl Shape {
    /// That of fans with the given points.
    pub(crate) fn new(fans: &Fans, points: &[DVec3]) -> Self {
        let of_line = |(number, line): (usize, &ComplexEdge)| {
            (*line, points[fans.point_of_line(number)] - fans.middle(*line, points))
        };
        let lines = fans.lines.par_iter().enumerate().map(of_line).collect();
        let mut faces = vec![DVec3::ZERO; fans.faces.last().map_or(0, |face| face.index() + 1)];
        for (fan, face) in fans.faces.iter().enumerate().filter(|(fan, _)| fans.wall(*fan).is_none()) {
            faces[face.index()] = points[fans.center_of(fan)] - fans.mean_of_corners(fan, points);
        }
        Self { lines, faces }
    }

    /// How far a boundary bulges.
    pub(crate) fn bulge(&self, face: FaceId) -> DVec3 {
        self.faces.get(face.index()).copied().unwrap_or_default()
    }

    /// How far a line bulges.
    pub(crate) fn bulge_of_line(&self, line: ComplexEdge) -> DVec3 {
        let place = self.lines.binary_search_by_key(&line, |(line, _)| *line);
        place.map_or(DVec3::ZERO, |place| self.lines[place].1)
    }

    /// That of fans some of whose lines have got other ends: they are known by the boundaries that meet there.
    pub(crate) fn with_new_ends(mut self, before: &Fans, fans: &Fans) -> Self {
        let is_gone = |(_, line): &(usize, &ComplexEdge)| fans.lines.binary_search(line).is_err();
        let gone = before.lines.par_iter().enumerate().filter(is_gone);
        let gone: HashMap<Vec<FaceId>, DVec3> =
            gone.map(|(number, _)| (before.faces_of_line(number), self.lines[number].1)).collect();
        let of_line = |(number, line): (usize, &ComplexEdge)| {
            let known = self.lines.binary_search_by_key(line, |(line, _)| *line);
            let bulge = match known {
                Ok(place) => self.lines[place].1,
                Err(_) => gone.get(&fans.faces_of_line(number)).copied().unwrap_or_default(),
            };
            (*line, bulge)
        };
        self.lines = fans.lines.par_iter().enumerate().map(of_line).collect();
        self
    }

    /// The points of fans in this shape, with the vertices where the complex has them. What would be folded is flat.
    pub(crate) fn points(&self, complex: &CellComplex, fans: &Fans) -> Vec<DVec3> {
        let mut points = complex.vertices[..fans.vertex_count()].to_vec();
        let of_line = |line: &ComplexEdge| fans.middle(*line, &complex.vertices) + self.bulge_of_line(*line);
        points.par_extend(fans.lines.par_iter().map(of_line));
        let of_face =
            |(fan, face): (usize, &FaceId)| fans.mean_of_corners(fan, &complex.vertices) + self.bulge(*face);
        points.par_extend(fans.faces.par_iter().enumerate().map(of_face));
        // Flattening one boundary may fold another, as they share lines. Some are folded even when flat.
        let mut flat = vec![false; fans.faces.len()];
        loop {
            let mut folded = fans.folded(&points, LARGEST_FOLD);
            folded.retain(|fan| !std::mem::replace(&mut flat[*fan], true));
            if folded.is_empty() {
                return points;
            }
            for fan in folded {
                for slot in fans.slots_of(fan)[..fans.rim_len(fan)].iter().skip(1).step_by(2) {
                    let line = fans.lines[slot.point as usize - fans.vertex_count()];
                    points[slot.point as usize] = fans.middle(line, &points);
                }
                points[fans.center_of(fan)] = fans.mean_of_corners(fan, &points);
            }
        }
    }

    /// The complex with whole cells, and the control points of its network with fans in this shape.
    pub(crate) fn cells(&self, complex: &CellComplex) -> (Tessellation, Vec<DVec3>) {
        let (cells, corners) = complex.tessellation();
        let mut points = cells.vertices().to_vec();
        let mean = |points: &[DVec3], some: &[voronoi::VertexId]| {
            some.iter().map(|vertex| points[vertex.index()]).sum::<DVec3>() / some.len() as f64
        };
        for ends in &cells.edges().ends {
            let bulge = self.bulge_of_line(line_of(&corners, *ends));
            points.push(mean(&points, ends) + bulge);
        }
        for (face, number) in cells.faces().zip(face_numbers(complex, &cells)) {
            points.push(mean(&points, cells.face_corners(face)) + self.bulge(number));
        }
        (cells, points)
    }
}

/// The face of a complex that each face of its cells is, or is a copy of.
pub(crate) fn face_numbers(complex: &CellComplex, cells: &Tessellation) -> Vec<FaceId> {
    let mut numbers = complex.faces();
    let copied: Vec<FaceId> =
        cells.periodic_faces().iter().map(|pair| numbers[pair.primary.index()]).collect();
    numbers.extend(copied);
    numbers
}

/// The line of a complex that leads from one vertex of its cells to another; `corners` has the complex's vertices of these.
pub(crate) fn line_of(corners: &[PeriodicVertex], ends: [voronoi::VertexId; 2]) -> ComplexEdge {
    ComplexEdge::between(ends.map(|end| corners[end.index()]))
}

/// Some sides, each once and sorted; a cell and its images are one.
pub(crate) fn distinct(sides: impl IntoIterator<Item = Side>) -> Vec<Side> {
    let sides = sides.into_iter().map(|side| match side {
        Side::Image(cell, _) => Side::Cell(cell),
        Side::Cell(_) | Side::Wall(_) => side,
    });
    let mut sides: Vec<Side> = sides.collect();
    sides.sort_unstable();
    sides.dedup();
    sides
}
