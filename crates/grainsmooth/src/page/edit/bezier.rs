//! Bezier curves and patches that are edited.

use glam::DVec3;
use subzero::{BezierCurve, BezierError, MeshError};

use super::super::grains::Frame;
use super::cage::{Cage, edges};
use super::command::Command;
use super::drawing::{Asked, Drawing};
use super::subdivided::{Subdivided, Surface};
use crate::error::mesh_file::MeshFileProblem;
use crate::mesh::BezierFile;
use crate::mesh::file::check_lengths;

/// Curves and patches by control points. Those at one place are one, so that patches stay joined.
#[derive(Debug, Clone)]
pub(super) struct EditedBezier {
    points: Vec<DVec3>,
    /// The control points of each curve, by number.
    curves: Vec<Vec<u32>>,
    /// The rows of control points of each patch, by number.
    patches: Vec<Vec<Vec<u32>>>,
}

impl EditedBezier {
    /// # Errors
    /// [`MeshError::TooLarge`] if there are more points than 32-bit ids can count.
    pub(super) fn new(file: &BezierFile) -> Result<Self, MeshError> {
        let mut all: Vec<DVec3> = file.curves.iter().flat_map(BezierCurve::control).copied().collect();
        all.extend(file.surface_control.iter().flatten().flatten());
        u32::try_from(all.len()).map_err(|_| MeshError::TooLarge { what: "points", count: all.len() })?;
        let key = |point: &DVec3| point.to_array().map(|coordinate| (coordinate + 0.0).to_bits());
        let mut numbers = std::collections::BTreeMap::new();
        let mut points = Vec::new();
        let mut number = |point: &DVec3| {
            *numbers.entry(key(point)).or_insert_with(|| {
                points.push(*point);
                u32::try_from(points.len() - 1).unwrap_or(u32::MAX)
            })
        };
        let curves =
            file.curves.iter().map(|curve| curve.control().iter().map(&mut number).collect()).collect();
        let patches = file.surface_control.iter();
        let patches = patches
            .map(|rows| rows.iter().map(|row| row.iter().map(&mut number).collect()).collect())
            .collect();
        Ok(Self { points, curves, patches })
    }

    pub(super) fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// Number of curves and patches.
    pub(super) fn count(&self) -> usize {
        self.curves.len() + self.patches.len()
    }

    pub(super) fn apply(&mut self, command: &Command) -> Result<String, MeshFileProblem> {
        match command {
            Command::Move { point, to } => {
                self.hold(*point, DVec3::from_array(*to))?;
                Ok(format!("moved control point {point}"))
            }
            _ => Err(MeshFileProblem::OnlyControlPoints),
        }
    }

    /// Puts a point elsewhere; returns where it was.
    pub(super) fn hold(&mut self, point: u32, place: DVec3) -> Result<DVec3, MeshFileProblem> {
        let (what, index, vertex_count) = ("command", 0, self.points.len());
        let held = self.points.get_mut(point as usize);
        let held = held.ok_or(MeshError::VertexOutOfRange { what, index, vertex: point, vertex_count })?;
        check_lengths(&[place])?;
        Ok(std::mem::replace(held, place))
    }

    fn at(&self, numbers: &[u32]) -> Vec<DVec3> {
        numbers.iter().map(|number| self.points[*number as usize]).collect()
    }

    fn curve(&self, numbers: &[u32]) -> Result<BezierCurve<DVec3>, BezierError> {
        BezierCurve::new(self.at(numbers))
    }

    /// The curves and patches as files have them.
    pub(super) fn file(&self) -> Result<BezierFile, MeshFileProblem> {
        let mut file = BezierFile::default();
        for curve in &self.curves {
            file.add_curve(self.at(curve))?;
        }
        for rows in &self.patches {
            file.add_surface(rows.iter().map(|row| self.at(row)).collect())?;
        }
        Ok(file)
    }

    /// The control points, and the lines between those that are neighbours.
    pub(super) fn cage(&self, frame: Frame) -> Cage {
        let mut cage = Cage::of_points(&self.points, frame);
        let along = |lines: &mut dyn Iterator<Item = Vec<u32>>| -> Vec<[u32; 2]> {
            lines
                .flat_map(|line| line.windows(2).map(|ends| [ends[0], ends[1]]).collect::<Vec<_>>())
                .collect()
        };
        let mut edges = along(&mut self.curves.iter().cloned());
        for rows in &self.patches {
            edges.extend(along(&mut rows.iter().cloned()));
            let columns = (0..rows[0].len()).map(|column| rows.iter().map(|row| row[column]).collect());
            edges.extend(along(&mut columns.into_iter()));
        }
        edges.retain(|[a, b]| a != b);
        edges.iter_mut().for_each(|ends| ends.sort_unstable());
        edges.sort_unstable();
        edges.dedup();
        cage.edges = edges;
        cage
    }

    /// All curves, all patches as one mesh, and de Casteljau's points of one of them.
    pub(super) fn draw(&self, asked: &Asked, cage: &Cage) -> Result<Drawing, MeshFileProblem> {
        let mut drawing = Drawing::default();
        let segments = asked.samples.clamp(2, 200) - 1;
        for curve in &self.curves {
            drawing.add_line(self.curve(curve)?.sample(4 * segments), 0);
        }
        if !self.patches.is_empty() {
            let merged = self.file()?.merged(segments + 1, true)?;
            let faces: Vec<Vec<u32>> = merged.triangles.iter().map(|triangle| triangle.to_vec()).collect();
            let surface = Surface {
                edges: edges(&faces),
                points: merged.points,
                triangles: merged.triangles,
                generations: None,
            };
            drawing.surface = Some(Subdivided::Surface(surface));
            drawing.color(&asked.color, cage, &self.points, None);
        }
        for (level, points) in (1..).zip(self.construction(asked)?) {
            drawing.add_line(points, level);
        }
        Ok(drawing)
    }

    /// De Casteljau's points level by level: of a curve at t; of a patch along its rows to v, then along u through what comes out.
    fn construction(&self, asked: &Asked) -> Result<Vec<Vec<DVec3>>, MeshFileProblem> {
        let [t, v] = [asked.t, asked.v].map(|share| share.clamp(0.0, 1.0));
        if let Some(curve) = self.curves.get(asked.patch) {
            return Ok(self.curve(curve)?.casteljau(t).split_off(1));
        }
        let Some(rows) = asked.patch.checked_sub(self.curves.len()).and_then(|patch| self.patches.get(patch))
        else {
            return Ok(Vec::new());
        };
        let rows: Vec<BezierCurve<DVec3>> =
            rows.iter().map(|row| self.curve(row)).collect::<Result<_, _>>()?;
        let across = BezierCurve::new(rows.iter().map(|row| row.point(v)).collect())?;
        Ok(across.casteljau(t))
    }
}
