//! Control points of Bezier curves and surfaces from a file, and the curves and surfaces as points and cells.

use std::path::Path;

use glam::DVec3;
use serde::Deserialize;
use subzero::{BezierCurve, BezierError, BezierSurface, MergedSurfaces};

use super::file::json_point::JsonPoint;
use super::file::{MeshFileProblem, check_lengths, control_points};
use crate::Error;

/// Curves and surfaces as a file gives them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BezierFile {
    /// Curves of any degree.
    pub curves: Vec<BezierCurve<DVec3>>,
    /// Tensor-product surfaces, such as bicubic patches.
    pub surfaces: Vec<BezierSurface<DVec3>>,
    /// The control points of each surface, as rows along u.
    pub surface_control: Vec<Vec<Vec<DVec3>>>,
}

/// Reads control points: from JSON where the extension is .json, else from plain text.
///
/// JSON has `curves` (each a list of points, or an object with `control`), `surfaces` or `surface` (lists of rows of
/// points, or objects with `control`), or one `control`. Plain text has one point per line, x y z, or x y in the plane; a blank
/// line ends a curve. A line with two numbers `m n` begins a surface of these degrees, with (m + 1)(n + 1) points after it; that
/// is the format of the Utah teapot's files, whose first line is the number of patches.
///
/// # Errors
/// [`Error::MeshFile`] names the line, or the curve or surface that lacks points.
pub fn read_bezier(path: &Path) -> Result<BezierFile, Error> {
    let read = || {
        let bytes = std::fs::read(path).map_err(MeshFileProblem::Unreadable)?;
        let is_json = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
        let file = if is_json { from_json(&bytes)? } else { from_text(&String::from_utf8_lossy(&bytes))? };
        if file.curves.is_empty() && file.surfaces.is_empty() {
            return Err(BezierError::NoControlPoints.into());
        }
        for curve in file.curves.iter().chain(file.surfaces.iter().flat_map(BezierSurface::rows)) {
            check_lengths(curve.control())?;
        }
        Ok(file)
    };
    read().map_err(|problem| Error::MeshFile { path: path.to_owned(), problem })
}

impl BezierFile {
    /// The Utah teapot.
    pub(crate) fn teapot() -> Self {
        let surfaces = subzero::teapot();
        let rows = |surface: &BezierSurface<DVec3>| {
            surface.rows().iter().map(|row| row.control().to_vec()).collect()
        };
        Self { curves: Vec::new(), surface_control: surfaces.iter().map(rows).collect(), surfaces }
    }

    pub(crate) fn add_curve(&mut self, control: Vec<DVec3>) -> Result<(), MeshFileProblem> {
        subzero::check_finite(&control)?;
        self.curves.push(BezierCurve::new(control)?);
        Ok(())
    }

    pub(crate) fn add_surface(&mut self, control: Vec<Vec<DVec3>>) -> Result<(), MeshFileProblem> {
        control.iter().try_for_each(|row| subzero::check_finite(row))?;
        self.surfaces.push(BezierSurface::new(control.clone())?);
        self.surface_control.push(control);
        Ok(())
    }

    /// Each curve as a polyline through `samples` points at even steps of the parameter.
    ///
    /// # Errors
    /// [`BezierError::TooLarge`] if there are more points than 32-bit ids can count.
    pub fn polylines(&self, samples: u32) -> Result<(Vec<DVec3>, Vec<Vec<u32>>), BezierError> {
        let mut points = Vec::new();
        let mut polylines = Vec::new();
        for curve in &self.curves {
            let first = first_id(points.len(), samples as usize)?;
            points.extend(curve.sample(samples - 1));
            polylines.push((first..first + samples).collect());
        }
        Ok((points, polylines))
    }

    /// De Casteljau's points, level by level: of each curve at `t`; of each surface along all rows to `v`, then along u through what comes out to `t`.
    ///
    /// # Errors
    /// [`BezierError::TooLarge`] if there are more points than 32-bit ids can count.
    pub fn construction(&self, t: f64, v: f64) -> Result<Construction, BezierError> {
        let mut all = Construction::default();
        for curve in &self.curves {
            all.add(curve.casteljau(t), 0)?;
        }
        for surface in &self.surfaces {
            for row in surface.rows() {
                let mut levels = row.casteljau(v);
                // The last point is one of the control points along u.
                levels.pop();
                all.add(levels, 0)?;
            }
            all.add(surface.curve_along_u(v).casteljau(t), surface.rows()[0].degree())?;
        }
        Ok(all)
    }

    /// All surfaces as one mesh over `samples` x `samples` points each, with holes filled if so asked.
    ///
    /// # Errors
    /// As of [`MergedSurfaces::new`].
    pub fn merged(&self, samples: u32, fill: bool) -> Result<MergedSurfaces, BezierError> {
        MergedSurfaces::new(&self.surfaces, samples - 1, fill)
    }

    /// Each surface as triangles over `samples` x `samples` points, with the unit normals of the points; zero where a surface
    /// has none.
    ///
    /// # Errors
    /// [`BezierError::TooLarge`] if there are more points than 32-bit ids can count.
    #[expect(clippy::type_complexity, reason = "points, normals and triangles, used in one place")]
    pub fn triangles(&self, samples: u32) -> Result<(Vec<DVec3>, Vec<DVec3>, Vec<[u32; 3]>), BezierError> {
        let (mut points, mut normals, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
        for surface in &self.surfaces {
            let first = first_id(points.len(), (samples as usize).saturating_mul(samples as usize))?;
            let (more_points, more_triangles) = surface.tessellate(samples - 1, samples - 1)?;
            points.extend(more_points);
            normals.extend(grid(samples).map(|[u, v]| surface.normal(u, v).unwrap_or_default()));
            triangles.extend(more_triangles.iter().map(|corners| corners.map(|id| first + id)));
        }
        Ok((points, normals, triangles))
    }
}

/// The levels of de Casteljau's scheme on all curves of a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Construction {
    /// The points of all levels of all curves and surfaces.
    pub points: Vec<DVec3>,
    /// The level of each point: 0 for control points.
    pub levels: Vec<i32>,
    /// The points of each level with two or more of them.
    pub lines: Vec<Vec<u32>>,
    /// The level of each line.
    pub line_levels: Vec<i32>,
}

impl Construction {
    /// Adds the levels of a curve, counted from `first_level`.
    fn add(&mut self, levels: Vec<Vec<DVec3>>, first_level: usize) -> Result<(), BezierError> {
        for (level, points) in (first_level..).zip(levels) {
            // No degree is that high.
            let level = i32::try_from(level).unwrap_or(i32::MAX);
            let first = first_id(self.points.len(), points.len())?;
            let ids: Vec<u32> = (first..).take(points.len()).collect();
            self.levels.extend(points.iter().map(|_| level));
            self.points.extend(points);
            // The last level is a point on the curve.
            if ids.len() > 1 {
                self.lines.push(ids);
                self.line_levels.push(level);
            }
        }
        Ok(())
    }
}

/// The parameters of a surface's points, v running fastest.
pub(crate) fn grid(samples: u32) -> impl Iterator<Item = [f64; 2]> {
    (0..samples).flat_map(move |i| (0..samples).map(move |j| [step(i, samples), step(j, samples)]))
}

/// The parameter of a curve's point.
pub(crate) fn step(i: u32, samples: u32) -> f64 {
    f64::from(i) / f64::from(samples - 1)
}

/// The id of the first of some points more.
fn first_id(points: usize, more: usize) -> Result<u32, BezierError> {
    let too_large = |count| BezierError::TooLarge { what: "points", count };
    let count = points.saturating_add(more);
    u32::try_from(count).map_err(|_| too_large(count))?;
    u32::try_from(points).map_err(|_| too_large(points))
}

#[derive(Deserialize)]
struct JsonFile {
    #[serde(default)]
    curves: Vec<Control<Vec<JsonPoint>>>,
    #[serde(default, alias = "patches")]
    surfaces: Vec<Control<Vec<Vec<JsonPoint>>>>,
    #[serde(default)]
    surface: Option<Control<Vec<Vec<JsonPoint>>>>,
    #[serde(default)]
    control: Option<CurveOrSurface>,
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "control points are [x, y, z] or [x, y] in lists, a list of lists for a surface"
)]
enum Control<T> {
    Named { control: T },
    Bare(T),
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "control points are [x, y, z] or [x, y] in a list, or in a list of lists for a surface"
)]
enum CurveOrSurface {
    Curve(Vec<JsonPoint>),
    Surface(Vec<Vec<JsonPoint>>),
}

impl<T> Control<T> {
    fn points(self) -> T {
        match self {
            Self::Named { control } | Self::Bare(control) => control,
        }
    }
}

fn from_json(bytes: &[u8]) -> Result<BezierFile, MeshFileProblem> {
    let mut json: JsonFile = serde_json::from_slice(bytes)
        .map_err(|error| MeshFileProblem::Line { line: error.line(), what: error.to_string() })?;
    match json.control {
        Some(CurveOrSurface::Curve(points)) => json.curves.push(Control::Bare(points)),
        Some(CurveOrSurface::Surface(rows)) => json.surfaces.push(Control::Bare(rows)),
        None => {}
    }
    let points = |row: Vec<JsonPoint>| row.into_iter().map(|JsonPoint(point)| point).collect();
    let mut file = BezierFile::default();
    for curve in json.curves {
        file.add_curve(points(curve.points()))?;
    }
    for surface in json.surfaces.into_iter().chain(json.surface) {
        file.add_surface(surface.points().into_iter().map(points).collect())?;
    }
    Ok(file)
}

fn from_text(text: &str) -> Result<BezierFile, MeshFileProblem> {
    let found = control_points::read(text)?;
    let mut file = BezierFile::default();
    found.curves.into_iter().try_for_each(|curve| file.add_curve(curve))?;
    found.surfaces.into_iter().try_for_each(|surface| file.add_surface(surface))?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_name_the_place() {
        let ragged = r#"{"surface": [[[0, 0, 0], [1, 0, 0]], [[0, 1, 0]]]}"#;
        let error = from_json(ragged.as_bytes()).unwrap_err().to_string();
        assert_eq!(
            error,
            "row 1 of the control points has 1 points, but the first row has 2; make all rows equally long"
        );
    }
}
