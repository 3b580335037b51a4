//! What is drawn of something that is edited, beside the points, edges and triangles that can be picked.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::super::grains::Frame;
use super::super::packed::Packed;
use super::cage::Cage;
use super::coloring::values;
use super::subdivided::Subdivided;

/// What a page wants to see.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct Asked {
    /// A scheme of subdivision by its name on the command line.
    pub(super) scheme: String,
    /// Steps of it.
    pub(super) level: u32,
    /// `generation`, `curvature`, `valence`, or nothing.
    pub(super) color: String,
    /// Parameters of de Casteljau's points.
    pub(super) t: f64,
    pub(super) v: f64,
    /// Which curve or patch shows them.
    pub(super) patch: usize,
    /// Points along a curve and each side of a patch.
    pub(super) samples: u32,
}

impl Default for Asked {
    fn default() -> Self {
        let (scheme, color) = (String::new(), String::new());
        Self { scheme, level: 0, color, t: 0.5, v: 0.5, patch: 0, samples: 17 }
    }
}

/// Marks, surfaces and lines.
#[derive(Debug, Default)]
pub(super) struct Drawing {
    pub(super) creases: Vec<([u32; 2], Option<f32>)>,
    pub(super) corners: Vec<(u32, Option<f32>)>,
    /// A surface that follows from the points.
    pub(super) surface: Option<Subdivided>,
    /// Numbers at its points, or at those of the cage where there is none.
    pub(super) values: Option<Vec<f64>>,
    /// Lines that follow from the points, each with its level.
    pub(super) lines: Vec<(Vec<DVec3>, u32)>,
}

/// What a page hears of a drawing beside its arrays.
#[derive(Serialize)]
pub(super) struct DrawingHead {
    creases: Vec<([u32; 2], Option<f32>)>,
    corners: Vec<(u32, Option<f32>)>,
    /// Number of points and level of each line.
    lines: Vec<(usize, u32)>,
    /// Whether a surface follows from the points, or is theirs.
    has_surface: bool,
    /// Steps from the base triangles to those of the surface; nothing where these are sent.
    steps: Option<u32>,
    edge_count: usize,
    /// Number of triangles of the surface.
    triangle_count: usize,
}

impl Drawing {
    /// Lines that follow from the points.
    pub(super) fn add_curves(&mut self, points: &[DVec3], lines: &[Vec<u32>]) {
        let places = |line: &Vec<u32>| line.iter().map(|point| points[*point as usize]).collect();
        self.lines.extend(lines.iter().map(|line| (places(line), 0)));
    }

    /// A line of a level of a construction.
    pub(super) fn add_line(&mut self, points: Vec<DVec3>, level: u32) {
        self.lines.push((points, level));
    }

    /// Colours the surface, or the faces between the points.
    pub(super) fn color(&mut self, color: &str, cage: &Cage, points: &[DVec3], generations: Option<&[i8]>) {
        self.values = match &self.surface {
            None => values(color, points, &cage.edges, &cage.triangles, generations),
            Some(surface) => surface.with_edges(|edges, triangles| {
                values(color, surface.points(), edges, triangles, surface.generations())
            }),
        };
    }

    /// The arrays for the page, in its frame.
    pub(super) fn packed(&self, frame: Frame, cage: &Cage) -> Packed {
        let mut packed = Packed::default();
        packed.floats("points", cage.points.iter().flat_map(|point| point.as_vec3().to_array()));
        packed.ids("edges", cage.edges.as_flattened().iter().copied());
        packed.ids("triangles", cage.triangles.as_flattened().iter().copied());
        if let Some(surface) = &self.surface {
            let places = surface.points().iter().flat_map(|point| frame.place(*point));
            packed.floats("surface_points", places);
            match surface.base() {
                Some((base, _)) => {
                    packed.ids("base_triangles", base.triangles().as_flattened().iter().copied());
                    packed.ids("base_edges", base.directed_edges().as_flattened().iter().copied());
                }
                None => surface.with_edges(|edges, triangles| {
                    packed.ids("surface_triangles", triangles.as_flattened().iter().copied());
                    packed.ids("surface_edges", edges.as_flattened().iter().copied());
                }),
            }
        }
        if let Some(values) = &self.values {
            #[expect(clippy::cast_possible_truncation, reason = "colours need no more digits")]
            packed.floats("values", values.iter().map(|value| *value as f32));
        }
        let of_lines = self.lines.iter().flat_map(|(points, _)| points);
        packed.floats("line_points", of_lines.flat_map(|point| frame.place(*point)));
        packed
    }

    /// What the page hears beside them.
    pub(super) fn head(&self, cage: &Cage) -> DrawingHead {
        DrawingHead {
            creases: self.creases.clone(),
            corners: self.corners.clone(),
            lines: self.lines.iter().map(|(points, level)| (points.len(), *level)).collect(),
            has_surface: self.surface.is_some(),
            steps: self.surface.as_ref().and_then(|surface| Some(surface.base()?.1)),
            edge_count: cage.edge_count(),
            triangle_count: match &self.surface {
                Some(surface) => surface.triangle_count(),
                None => cage.triangle_count(),
            },
        }
    }
}
