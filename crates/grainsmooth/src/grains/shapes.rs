//! The shapes that grains were to have, and those that they have.

use std::f64::consts::{FRAC_PI_3, PI, TAU};
use std::fmt;

use glam::{DMat2, DMat3, DQuat, DVec3};
use polycrystal::{GrainId, Measures};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde::Serialize;
use voronoi::Dimension;
use voronoi::volumes::{GrainDiagram, GrainShape, VolumesError};

use crate::seeds::random::unit_fraction;
use crate::{Config, Error, GrainCells};

/// The generator's stream for directions, apart from those of positions (0), orientations (1, 2) and sizes (3).
const STREAM: u64 = 4;

/// The shapes of grains that are several cells each.
#[derive(Debug, Clone, PartialEq)]
pub struct GrainShapes {
    dimension: Dimension,
    asked: String,
    wanted: Vec<GrainShape>,
    diagram: Box<GrainDiagram>,
    /// Grains that are rounder than was asked for.
    rounder: usize,
    /// Of each grain in the flat cells.
    ratios_of_cells: Vec<f64>,
}

/// How near grains came to the shapes that were asked for. Ratios are the length of the ellipsoid (in the plane: the ellipse) with a grain's
/// second moments over its least width; medians of all grains.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShapesReached {
    /// What was asked for.
    pub asked: String,
    /// The ratio that was asked for.
    pub ratio_asked: f64,
    /// That of the flat cells.
    pub ratio_of_cells: f64,
    /// That of the finished grains; none of cells alone.
    pub ratio: Option<f64>,
    /// Mean number of cells that make up a grain.
    pub cells_per_grain: f64,
    /// Number of grains that got a rounder shape than was asked for, so as not to be in pieces or folded.
    pub rounder: usize,
}

impl Config {
    /// The shapes that so many grains are to have, where some are asked for.
    pub(crate) fn wanted_shapes(&self, count: usize) -> Result<Option<Vec<GrainShape>>, Error> {
        let Some(source) = &self.grain_shapes else { return Ok(None) };
        let mut generator = ChaCha8Rng::seed_from_u64(self.random_seed);
        generator.set_stream(STREAM);
        let mut fraction = || unit_fraction(generator.next_u64());
        let rotation = || match self.dimension {
            Dimension::Two => DMat3::from_rotation_z(PI * fraction()),
            Dimension::Three => DMat3::from_quat(random_rotation([fraction(), fraction(), fraction()])),
        };
        source.shapes(self.dimension, count, rotation).map(Some)
    }
}

/// A rotation such that all are as likely, of three numbers from 0 to 1 (Shoemake 1992).
fn random_rotation([share, first, second]: [f64; 3]) -> DQuat {
    let [(sine, cosine), (other_sine, other_cosine)] = [first, second].map(|turn| (TAU * turn).sin_cos());
    let (a, b) = ((1.0 - share).sqrt(), share.sqrt());
    DQuat::from_xyzw(a * sine, a * cosine, b * other_sine, b * other_cosine)
}

impl GrainShapes {
    /// What became of the shapes asked for in a diagram.
    pub(crate) fn of_diagram(asked: String, wanted: Vec<GrainShape>, diagram: GrainDiagram) -> Self {
        let dimension = diagram.tessellation().domain().dimension();
        let moments = diagram.second_moments();
        let ratios_of_cells = match dimension {
            Dimension::Three => moments.into_iter().map(|moment| ratio_in_space(inertia(moment))).collect(),
            Dimension::Two => {
                moments.into_iter().map(|moment| ratio_in_plane(DMat2::from_mat3(moment))).collect()
            }
        };
        let rounder = diagram.contrasts().iter().filter(|contrast| **contrast < 1.0).count();
        Self { dimension, asked, wanted, diagram: Box::new(diagram), rounder, ratios_of_cells }
    }

    /// The same with rounder shapes of some grains, of all where none is told, whose cells lead to no network; nothing where these are balls.
    ///
    /// # Errors
    /// As of [`GrainDiagram::rounder`].
    pub(crate) fn with_rounder(&self, grains: &[GrainId]) -> Result<Option<Self>, VolumesError> {
        let all: Vec<usize> = match grains {
            [] => (0..self.wanted.len()).collect(),
            some => some.iter().map(|grain| grain.index()).collect(),
        };
        let rounder = self.diagram.rounder(all)?;
        Ok(rounder.map(|diagram| Self::of_diagram(self.asked.clone(), self.wanted.clone(), diagram)))
    }

    /// The cells.
    pub(crate) fn diagram(&self) -> &GrainDiagram {
        &self.diagram
    }

    /// The grain of each cell.
    pub(crate) fn grain_cells(&self) -> GrainCells {
        GrainCells::new(self.diagram.grain_of_cell(), self.diagram.moves(), self.wanted.len())
    }

    /// What was asked for and reached, by what the finished grains are like.
    pub(crate) fn reached(&self, measures: Option<&Measures>) -> ShapesReached {
        let ratio = |shape: &GrainShape| {
            let DVec3 { x, y, .. } = shape.lengths;
            match self.dimension {
                Dimension::Two => x.max(y) / x.min(y),
                Dimension::Three => shape.lengths.max_element() / shape.lengths.min_element(),
            }
        };
        ShapesReached {
            asked: self.asked.clone(),
            ratio_asked: median(self.wanted.iter().map(ratio).collect()),
            ratio_of_cells: median(self.ratios_of_cells.clone()),
            ratio: measures.map(|measures| median(ratios(measures))),
            cells_per_grain: self.diagram.grain_of_cell().len() as f64 / self.wanted.len() as f64,
            rounder: self.rounder,
        }
    }
}

/// Of each grain, the ratio of the largest and the least length by its second moments.
fn ratios(measures: &Measures) -> Vec<f64> {
    match measures {
        Measures::Space(space) => space.grains.iter().map(|grain| ratio_in_space(grain.inertia)).collect(),
        Measures::Plane(plane) => {
            plane.grains.iter().map(|grain| ratio_in_plane(grain.second_moment)).collect()
        }
    }
}

/// The moment of inertia of a second moment.
fn inertia(moment: DMat3) -> DMat3 {
    DMat3::from_diagonal(DVec3::splat(moment.x_axis.x + moment.y_axis.y + moment.z_axis.z)) - moment
}

/// Of a moment of inertia I the integrals of squares along its axes are half the trace less each eigenvalue. Eigenvalues are by Smith 1961.
fn ratio_in_space(inertia: DMat3) -> f64 {
    let trace = inertia.x_axis.x + inertia.y_axis.y + inertia.z_axis.z;
    let rest = inertia - DMat3::from_diagonal(DVec3::splat(trace / 3.0));
    let squares: f64 = rest.to_cols_array().iter().map(|entry| entry * entry).sum();
    let size = (squares / 6.0).sqrt();
    if size == 0.0 {
        return 1.0;
    }
    let angle = ((rest * (1.0 / size)).determinant() / 2.0).clamp(-1.0, 1.0).acos() / 3.0;
    // From the largest eigenvalue, across which a grain is narrow, to the least.
    let [narrow, long] = [angle, angle + 2.0 * FRAC_PI_3].map(|angle| trace / 6.0 - 2.0 * size * angle.cos());
    (long / narrow).sqrt()
}

fn ratio_in_plane(moment: DMat2) -> f64 {
    let mean = 0.5 * (moment.x_axis.x + moment.y_axis.y);
    let rest = (0.5 * (moment.x_axis.x - moment.y_axis.y)).hypot(moment.x_axis.y);
    ((mean + rest) / (mean - rest)).sqrt()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(1.0)
}

/// The lines of a summary.
impl fmt::Display for ShapesReached {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { asked, ratio_asked, ratio_of_cells, ratio, cells_per_grain, rounder } = self;
        writeln!(
            out,
            "shapes      asked {asked}, grains {ratio_asked:.2} times as long as wide; {cells_per_grain:.1} cells a grain"
        )?;
        write!(out, "            reached {ratio_of_cells:.2} in the flat cells")?;
        if let Some(ratio) = ratio {
            write!(out, ", {ratio:.2} in the finished grains")?;
        }
        match rounder {
            0 => writeln!(out, " (medians)"),
            1 => {
                writeln!(out, " (medians); 1 grain is rounder than asked, as it would be in pieces or folded")
            }
            _ => writeln!(
                out,
                " (medians); {rounder} grains are rounder than asked, as they would be in pieces or folded"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_have_the_ratio_of_their_sides() {
        let turn = DMat3::from_rotation_x(0.4) * DMat3::from_rotation_z(1.0);
        let squares = DVec3::new(4.0, 25.0, 9.0);
        let inertia = DMat3::from_diagonal(squares.element_sum() - squares);
        let ratio = ratio_in_space(turn * inertia * turn.transpose());
        assert!((ratio - 2.5).abs() < 1e-12, "{ratio}");
        assert!((ratio_in_space(DMat3::IDENTITY) - 1.0).abs() < 1e-12);
        let turn = DMat2::from_angle(0.7);
        let moment = turn * DMat2::from_diagonal(glam::DVec2::new(9.0, 1.0)) * turn.transpose();
        assert!((ratio_in_plane(moment) - 3.0).abs() < 1e-12);
    }
}
