//! What is drawn of something that is edited: the points that can be taken hold of, and what follows from them.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::super::grains::Frame;
use super::super::packed::Packed;
use super::coloring::values;
use crate::Scene;

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

/// Points, faces and lines, by layer.
#[derive(Debug, Default)]
pub(super) struct Drawing {
    /// Points that can be moved.
    pub(super) points: Vec<DVec3>,
    /// Edges between them.
    pub(super) edges: Vec<[u32; 2]>,
    /// Triangles between them.
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) creases: Vec<([u32; 2], Option<f32>)>,
    pub(super) corners: Vec<(u32, Option<f32>)>,
    /// A surface that follows from the points.
    surface: Surface,
    /// Lines that follow from them, each with its level.
    lines: Vec<(Vec<DVec3>, u32)>,
}

#[derive(Debug, Default)]
struct Surface {
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
    values: Option<Vec<f64>>,
}

/// What a page hears of a drawing beside its arrays.
#[derive(Serialize)]
struct Head<'a, T> {
    #[serde(flatten)]
    more: &'a T,
    middle: [f64; 3],
    unit: f64,
    creases: &'a [([u32; 2], Option<f32>)],
    corners: &'a [(u32, Option<f32>)],
    /// Number of points and level of each line.
    lines: Vec<(usize, u32)>,
    /// Whether a surface follows from the points, or is theirs.
    has_surface: bool,
    /// Number of faces' corners of the surface.
    triangle_count: usize,
}

impl Drawing {
    /// Points alone.
    pub(super) fn of_points(points: Vec<DVec3>) -> Self {
        Self { points, ..Self::default() }
    }

    /// Faces between the points.
    pub(super) fn add_faces(&mut self, faces: &[Vec<u32>]) {
        self.edges = edges(faces);
        self.triangles = triangles(&self.points, faces);
    }

    /// Polylines between the points.
    pub(super) fn add_polylines(&mut self, lines: &[Vec<u32>]) {
        self.edges = lines.iter().flat_map(|line| line.windows(2).map(|ends| [ends[0], ends[1]])).collect();
    }

    /// Lines that follow from the points.
    pub(super) fn add_curves(&mut self, points: &[DVec3], lines: &[Vec<u32>]) {
        let places = |line: &Vec<u32>| line.iter().map(|point| points[*point as usize]).collect();
        self.lines.extend(lines.iter().map(|line| (places(line), 0)));
    }

    /// A line of a level of a construction.
    pub(super) fn add_line(&mut self, points: Vec<DVec3>, level: u32) {
        self.lines.push((points, level));
    }

    /// A surface that follows from the points.
    pub(super) fn add_level(
        &mut self,
        points: Vec<DVec3>,
        faces: &[Vec<u32>],
        generations: Option<Vec<i8>>,
        color: &str,
    ) {
        let triangles = triangles(&points, faces);
        let edges = edges(faces);
        let values = values(color, &points, &edges, &triangles, generations.as_deref());
        self.surface = Surface { points, triangles, edges, values };
    }

    /// Colours the faces between the points.
    pub(super) fn color_cage(&mut self, color: &str) {
        self.surface.values = values(color, &self.points, &self.edges, &self.triangles, None);
    }

    /// The arrays for the page, in its frame.
    pub(super) fn packed(&self, frame: Frame, more: &impl Serialize) -> serde_json::Result<Vec<u8>> {
        let mut packed = Packed::default();
        let place =
            |points: &[DVec3]| -> Vec<f32> { points.iter().flat_map(|point| frame.place(*point)).collect() };
        packed.floats("points", place(&self.points));
        packed.ids("edges", self.edges.as_flattened().iter().copied());
        packed.ids("triangles", self.triangles.as_flattened().iter().copied());
        let has_surface = !self.surface.triangles.is_empty();
        let (points, triangles) = match has_surface {
            true => (&self.surface.points, &self.surface.triangles),
            false => (&self.points, &self.triangles),
        };
        if has_surface {
            packed.floats("surface_points", place(&self.surface.points));
            packed.ids("surface_triangles", self.surface.triangles.as_flattened().iter().copied());
            packed.ids("surface_edges", self.surface.edges.as_flattened().iter().copied());
        }
        packed.small("normals", normals(points, triangles));
        if let Some(values) = &self.surface.values {
            #[expect(clippy::cast_possible_truncation, reason = "colours need no more digits")]
            packed.floats("values", values.iter().map(|value| *value as f32));
        }
        packed.floats("line_points", self.lines.iter().flat_map(|(points, _)| place(points)));
        packed.finish(&Head {
            more,
            middle: frame.middle().to_array(),
            unit: frame.unit(),
            creases: &self.creases,
            corners: &self.corners,
            lines: self.lines.iter().map(|(points, level)| (points.len(), *level)).collect(),
            has_surface,
            triangle_count: triangles.len(),
        })
    }
}

/// Each edge of some faces once.
fn edges(faces: &[Vec<u32>]) -> Vec<[u32; 2]> {
    let sides = |face: &Vec<u32>| -> Vec<[u32; 2]> {
        let next = face.iter().cycle().skip(1);
        face.iter().zip(next).map(|(&a, &b)| [a.min(b), a.max(b)]).collect()
    };
    let mut edges: Vec<[u32; 2]> = faces.iter().flat_map(sides).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

fn triangles(points: &[DVec3], faces: &[Vec<u32>]) -> Vec<[u32; 3]> {
    let all: Option<Vec<[u32; 3]>> = faces.iter().map(|face| face.as_slice().try_into().ok()).collect();
    all.unwrap_or_else(|| {
        Scene { points: points.to_vec(), faces: faces.to_vec(), ..Scene::default() }.triangles().0
    })
}

/// Normals at points, by the areas of the triangles around them, in steps of 1/127, four numbers each.
fn normals(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<i8> {
    let mut sums = vec![DVec3::ZERO; points.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|point| points[point as usize]);
        let normal = (b - a).cross(c - a);
        triangle.iter().for_each(|point| sums[*point as usize] += normal);
    }
    #[expect(clippy::cast_possible_truncation, reason = "from -127 to 127")]
    let steps = |cosine: f64| (127.0 * cosine).round() as i8;
    let packed = sums.into_iter().flat_map(|sum| {
        let [x, y, z] = sum.normalize_or_zero().to_array().map(steps);
        [x, y, z, 0]
    });
    packed.collect()
}
