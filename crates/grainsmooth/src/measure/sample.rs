//! Grains of a sample, as a network, a tessellation or a table tells them.

mod table;
mod tessellation;

use std::path::Path;

use glam::{BVec3, DVec3};
use polycrystal::{BoundaryId, GrainId, Measures, Side, Surface, measure};
use texture::{CrystalSymmetry, Orientation};
use toml::Value;
use voronoi::Dimension;

use crate::mesh::file::MeshFileProblem;
use crate::{Error, LabelledFile};

/// The part of a grain's surface that the sum of its normals may be: single precision leaves less.
const GAP_TOLERANCE: f64 = 1e-5;

/// Grains of a sample.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredSample {
    /// Two or three dimensions.
    pub dimension: Dimension,
    /// One or more.
    pub grains: Vec<MeasuredGrain>,
    /// The sides of the box that repeats or that grains fill, where the file tells it; z = 1 in the plane.
    pub box_size: Option<DVec3>,
    /// The axes along which it repeats.
    pub periodic: BVec3,
    /// The symmetry of the crystals, where the file tells it.
    pub symmetry: Option<CrystalSymmetry>,
}

/// What is known of a grain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredGrain {
    /// Its number in the file.
    pub id: u32,
    /// Volume; in the plane area.
    pub volume: f64,
    /// Area of the ball of the same volume over the grain's; in the plane the same of perimeters.
    pub sphericity: Option<f64>,
    /// Number of its faces; in the plane of sides.
    pub faces: Option<usize>,
    /// Whether it ends at a wall of the sample, as far as is known.
    pub is_cut: bool,
    /// The integrals of x^2, y^2 and z^2 about the centroid, over the volume.
    pub second_moment: Option<DVec3>,
    /// How its crystal stands.
    pub orientation: Option<Orientation>,
    /// The number of its phase.
    pub phase: Option<u32>,
}

impl MeasuredSample {
    /// Reads a network (.vtp, .vtu, .vtk), a tessellation (.tess) or a table (.csv, .txt, .json). A table that does not show it by its
    /// columns has grains of `dimension`.
    ///
    /// # Errors
    /// [`Error::MeshFile`], [`Error::Unreadable`] and [`Error::BadLine`].
    pub fn read(path: &Path, dimension: Option<Dimension>) -> Result<Self, Error> {
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        let problem = |problem| Error::MeshFile { path: path.to_owned(), problem };
        let sample = match extension.to_str() {
            Some("vtp" | "vtu" | "vtk") => of_network(&LabelledFile::read(path)?).map_err(problem)?,
            Some("tess") => tessellation::read(path)?,
            Some("csv" | "txt" | "json") => table::read(path, dimension)?,
            _ => return Err(problem(MeshFileProblem::NotASampleFormat)),
        };
        let is_bad = |grain: &&MeasuredGrain| !(grain.volume.is_finite() && grain.volume > 0.0);
        match sample.grains.iter().find(is_bad) {
            None => Ok(sample),
            Some(grain) => Err(problem(MeshFileProblem::NoVolume { grain: grain.id, volume: grain.volume })),
        }
    }

    /// Equivalent diameters of all grains.
    pub fn diameters(&self) -> Vec<f64> {
        self.grains.iter().map(|grain| self.dimension.ball_diameter(grain.volume)).collect()
    }

    /// Volume of all grains; in the plane area.
    pub fn volume(&self) -> f64 {
        self.grains.iter().map(|grain| grain.volume).sum()
    }
}

fn of_network(file: &LabelledFile) -> Result<MeasuredSample, MeshFileProblem> {
    let points: Vec<DVec3> = file.points.iter().map(|point| *point * file.stretch).collect();
    let surface = Surface { points: &points, ..file.surface() };
    let dimension = surface.elements.dimension();
    let text = |key: &str| file.settings.as_ref()?.get(key)?.as_str();
    let periodic = BVec3::new(
        text("periodic").is_some_and(|axes| axes.contains('x')),
        text("periodic").is_some_and(|axes| axes.contains('y')),
        text("periodic").is_some_and(|axes| axes.contains('z')),
    );
    // Where all axes repeat and grains are whole nothing is a wall, whatever the names of the arrays tell.
    let axes = if dimension == Dimension::Two { BVec3::new(true, true, false) } else { BVec3::TRUE };
    let is_whole = periodic == axes && text("periodic-cut") != Some("box");
    let is_wall = |boundary: usize| !is_whole && !file.comes_again[boundary];
    let mut grains = grains_of(&surface, is_wall)?;
    for (grain, orientation) in file.orientations.iter().flatten() {
        if let Ok(place) = grains.binary_search_by_key(&grain.0, |grain| grain.id) {
            grains[place].orientation = Some(*orientation);
        }
    }
    for (grain, phase) in file.phases.iter().flatten() {
        if let Ok(place) = grains.binary_search_by_key(&grain.0, |grain| grain.id) {
            grains[place].phase = Some(*phase);
        }
    }
    let mut sample = MeasuredSample {
        dimension,
        grains,
        box_size: file.settings.as_ref().and_then(|settings| box_of(settings.get("box")?)),
        periodic,
        symmetry: text("crystal-symmetry").and_then(|name| name.parse().ok()),
    };
    sample.keep_box_if_filled(surface.points);
    Ok(sample)
}

fn box_of(setting: &Value) -> Option<DVec3> {
    let sides: Option<Vec<f64>> = setting.as_array()?.iter().map(Value::as_float).collect();
    match sides.as_deref() {
        Some(&[x, y]) => Some(DVec3::new(x, y, 1.0)),
        Some(&[x, y, z]) => Some(DVec3::new(x, y, z)),
        _ => None,
    }
}

impl MeasuredSample {
    /// Takes the box around some points where none is known, and none where the grains do not fill it.
    fn keep_box_if_filled(&mut self, points: &[DVec3]) {
        let lower = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let upper = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let around =
            if self.dimension == Dimension::Two { (upper - lower).with_z(1.0) } else { upper - lower };
        let size = self.box_size.unwrap_or(around);
        let is_filled = (self.volume() / size.element_product() - 1.0).abs() < GAP_TOLERANCE;
        self.box_size = is_filled.then_some(size);
    }
}

/// The grains of a surface, by number.
fn grains_of(
    surface: &Surface<'_>,
    is_wall: impl Fn(usize) -> bool,
) -> Result<Vec<MeasuredGrain>, MeshFileProblem> {
    let known = |id, volume, sphericity, second_moment| MeasuredGrain {
        id,
        volume,
        sphericity: Some(sphericity),
        faces: Some(0),
        is_cut: false,
        second_moment: Some(second_moment),
        orientation: None,
        phase: None,
    };
    // Of each boundary its size, and the sum of its normals.
    let mut sizes: Vec<(BoundaryId, f64, DVec3)> = Vec::new();
    let mut grains: Vec<MeasuredGrain> = match measure(surface) {
        Measures::Space(all) => {
            sizes.extend(
                all.boundaries.iter().map(|one| (one.boundary, one.area, one.mean_normal * one.area)),
            );
            let grain = |grain: &polycrystal::GrainMeasures| {
                // Of the moment of inertia about x, half of all three less itself is the integral of x^2.
                let inertia =
                    DVec3::new(grain.inertia.x_axis.x, grain.inertia.y_axis.y, grain.inertia.z_axis.z);
                let moment = (0.5 * inertia.element_sum() - inertia) / grain.volume;
                known(grain.grain.0, grain.volume, grain.sphericity, moment)
            };
            all.grains.iter().map(grain).collect()
        }
        Measures::Plane(all) => {
            let normal = |one: &polycrystal::PlaneBoundaryMeasures| {
                (one.boundary, one.length, (one.mean_normal * one.length).extend(0.0))
            };
            sizes.extend(all.boundaries.iter().map(normal));
            let grain = |grain: &polycrystal::PlaneGrainMeasures| {
                let moment = DVec3::new(grain.second_moment.x_axis.x, grain.second_moment.y_axis.y, 0.0);
                known(grain.grain.0, grain.area, grain.circularity, moment / grain.area)
            };
            all.grains.iter().map(grain).collect()
        }
    };
    let mut gaps = vec![(DVec3::ZERO, 0.0); grains.len()];
    for (boundary, size, normal) in sizes {
        let sides = surface.sides[boundary.index()];
        for (side, sign) in sides.iter().zip([1.0, -1.0]) {
            let Side::Grain(GrainId(id)) = side else { continue };
            let Ok(place) = grains.binary_search_by_key(id, |grain| grain.id) else { continue };
            gaps[place] = (gaps[place].0 + sign * normal, gaps[place].1 + size);
            let grain = &mut grains[place];
            grain.faces = grain.faces.map(|count| count + usize::from(size > 0.0));
            grain.is_cut |= sides.contains(&Side::Exterior) && is_wall(boundary.index());
        }
    }
    match grains.iter().zip(gaps).find(|(_, (sum, area))| sum.length() > GAP_TOLERANCE * area) {
        Some((grain, _)) => Err(MeshFileProblem::NotClosed { grain: grain.id }),
        None => Ok(grains),
    }
}
