//! Grains that are divided by a second tessellation each.

use std::fmt;

use glam::DVec3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rayon::prelude::*;
use serde::Serialize;
use voronoi::volumes::{DividedCells, Division, PowerDiagram, divide_cells, place_spheres};
use voronoi::{CellId, Dimension, Tessellation};

use super::quantiles::quantile_volumes;
use crate::config::inside::InsidePattern;
use crate::figures::significant::two_digits_down;
use crate::memory::{MemoryError, available_memory, check_cells};
use crate::names::PARENT;
use crate::seeds::random::unit_fraction;
use crate::vtk::ItemTuples;
use crate::{Config, Error, InsideError};

/// The first of the generator's streams for what divides grains, one for each, apart from those of all grains (0 to 3).
const FIRST_STREAM: u64 = 1 << 32;

/// Which grain each is a part of.
#[derive(Debug, Clone, PartialEq)]
pub struct Parents {
    /// The number of each parent's seed.
    ids: Vec<u32>,
    /// Index of each grain's parent.
    parent_of: Vec<usize>,
    patterns: Vec<Divided>,
}

/// What became of grains that were to be divided.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Divided {
    /// What was asked for.
    pub asked: String,
    /// Number of grains for which it was.
    pub grains: usize,
    /// How many of them are divided; the others are too small.
    pub divided: usize,
    /// Number of parts of these.
    pub parts: usize,
    /// Width of the lamellae or equivalent diameter of the cells that was asked for.
    pub length_asked: f64,
    /// The mean of all parts of divided grains.
    pub length: f64,
    #[serde(skip)]
    is_lamellar: bool,
}

/// Cells with those that are divided in parts.
pub(crate) struct InnerGrains {
    pub(crate) tessellation: Tessellation,
    pub(crate) weights: Vec<f64>,
    pub(crate) parents: Parents,
}

/// What is to divide a grain.
struct Plan {
    division: Division,
    /// The sum of what `length` of [`Divided`] is the mean of, over the parts, as if all were kept.
    lengths: f64,
}

impl InnerGrains {
    /// Divides cells of given phases as a config asks for; each keeps its volume. `ids` are the numbers of the cells' seeds.
    ///
    /// # Errors
    /// [`InsideError::NothingDivided`]; [`MemoryError::PartsExceedMemory`]; whatever keeps parts from having their volumes.
    pub(crate) fn new(
        config: &Config,
        tessellation: &Tessellation,
        weights: &[f64],
        phase_of: &[usize],
        ids: Vec<u32>,
    ) -> Result<Self, Error> {
        let stretch = config.stretch();
        let measures = tessellation.cell_measures();
        let pattern_of: Vec<Option<usize>> =
            phase_of.iter().map(|phase| config.pattern_inside(*phase)).collect();
        let dimension = config.dimension;
        let draw = |cell: usize| Inside {
            tessellation,
            cell: CellId(u32::try_from(cell).expect("cell ids fit 32 bits")),
            stretch,
            generator: {
                let mut generator = ChaCha8Rng::seed_from_u64(config.random_seed);
                generator.set_stream(FIRST_STREAM + cell as u64);
                generator
            },
        };
        let counts = pattern_of.par_iter().enumerate().map(|(cell, pattern)| match pattern {
            Some(pattern) => draw(cell).count(&config.inside[*pattern].pattern, measures[cell].volume),
            None => 1.0,
        });
        let counts: Vec<f64> = counts.collect();
        for (number, options) in config.inside.iter().enumerate() {
            let own = counts.iter().zip(&pattern_of).filter(|(_, pattern)| **pattern == Some(number));
            let most = own.map(|(count, _)| *count).fold(0.0, f64::max);
            if most < 2.0 {
                return Err(options.nothing_divided(dimension, most).into());
            }
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "too many take the largest"
        )]
        let all = counts.iter().sum::<f64>() as usize;
        check_cells(all, available_memory()).map_err(|error| match error {
            MemoryError::CellsExceedMemory { count, needed, available } => {
                MemoryError::PartsExceedMemory { count, needed, available }
            }
            error => error,
        })?;
        let plans = pattern_of.par_iter().enumerate().map(|(cell, pattern)| {
            let Some(pattern) = pattern.filter(|_| counts[cell] >= 2.0) else { return Ok(None) };
            draw(cell).plan(&config.inside[pattern].pattern, counts[cell], measures[cell].centroid).map(Some)
        });
        let plans = plans.collect::<Result<Vec<Option<Plan>>, Error>>()?;
        let lengths: Vec<f64> =
            plans.iter().map(|plan| plan.as_ref().map_or(0.0, |plan| plan.lengths)).collect();
        let divisions: Vec<Option<Division>> =
            plans.into_iter().map(|plan| plan.map(|plan| plan.division)).collect();
        let DividedCells { diagram, cell_of, .. } = divide_cells(tessellation, weights, &divisions)?;
        let parent_of: Vec<usize> = cell_of.iter().map(|cell| cell.index()).collect();
        let mut parts_of = vec![0; ids.len()];
        parent_of.iter().for_each(|parent| parts_of[*parent] += 1);
        let found = |(number, options): (usize, &crate::InsideOptions)| {
            let grains = (0..ids.len()).filter(|cell| pattern_of[*cell] == Some(number));
            let divided: Vec<usize> = grains.clone().filter(|cell| parts_of[*cell] > 1).collect();
            let parts: usize = divided.iter().map(|cell| parts_of[*cell]).sum();
            let (length_asked, is_lamellar) = match options.pattern {
                InsidePattern::Lamellae { width, .. } => (width, true),
                InsidePattern::Voronoi { diameter, .. } => (diameter, false),
            };
            let sum: f64 = divided.iter().map(|cell| lengths[*cell]).sum();
            Divided {
                asked: options.to_string(),
                grains: grains.count(),
                divided: divided.len(),
                parts,
                length_asked,
                length: sum / parts as f64,
                is_lamellar,
            }
        };
        let patterns = config.inside.iter().enumerate().map(found).collect();
        let parents = Parents { ids, parent_of, patterns };
        Ok(Self {
            tessellation: diagram.tessellation().clone(),
            weights: diagram.weights().to_vec(),
            parents,
        })
    }
}

/// A cell while it is looked at.
struct Inside<'a> {
    tessellation: &'a Tessellation,
    cell: CellId,
    /// By what coordinates are multiplied in the end: lengths are those of then.
    stretch: DVec3,
    generator: ChaCha8Rng,
}

impl Inside<'_> {
    /// The unit normal of lamellae, their width, and the middle of the cell and half its extent along the normal.
    fn across(&mut self, width: f64, normal: Option<DVec3>) -> (DVec3, f64, [f64; 2]) {
        let is_plane = self.tessellation.domain().dimension() == Dimension::Two;
        let random = || random_direction(is_plane, &mut self.generator);
        let normal = normal.map_or_else(random, DVec3::normalize);
        // A plane n . S x = d is one across S n before the stretch S.
        let before = normal * self.stretch;
        let (normal, width) = (before.normalize(), width / before.length());
        let faces = self.tessellation.cell_faces(self.cell).iter();
        let corners = faces.flat_map(|face| self.tessellation.face_corners(*face));
        let heights = corners.map(|corner| normal.dot(self.tessellation.vertices()[corner.index()]));
        let ends = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], height| {
            [low.min(height), high.max(height)]
        });
        (normal, width, [ends[0].midpoint(ends[1]), 0.5 * (ends[1] - ends[0])])
    }

    /// The number of parts that a pattern makes of the cell, below 2 for none: then by how much it is too large.
    fn count(&mut self, pattern: &InsidePattern, volume: f64) -> f64 {
        match *pattern {
            InsidePattern::Lamellae { width, normal } => {
                let (_, width, [_, half]) = self.across(width, normal);
                let count = 2.0 * half / width;
                if count < 2.0 { count } else { count.floor() }
            }
            InsidePattern::Voronoi { .. } => {
                let dimension = self.tessellation.domain().dimension();
                let spec = pattern.diameters().expect("of cells");
                let axes = dimension.axes().into();
                let mean = dimension.ball_volume(1.0) * spec.distribution(axes).moment(axes);
                // From 1.5 on the nearest whole number divides.
                let count = volume / mean;
                if count < 1.5 { count } else { count.round() }
            }
        }
    }

    /// What divides the cell in so many parts.
    fn plan(mut self, pattern: &InsidePattern, count: f64, centroid: DVec3) -> Result<Plan, Error> {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "memory was found to suffice"
        )]
        let whole = count as usize;
        match *pattern {
            InsidePattern::Lamellae { width, normal } => {
                let asked = width;
                let (normal, width, [middle, half]) = self.across(width, normal);
                // All are a width wide but for the ends, which share what is left over.
                let place = |part: usize| (part as f64 - 0.5 * (count - 1.0)) * width;
                let foot = centroid + normal * (middle - normal.dot(centroid));
                let points = (0..whole).map(|part| foot + normal * place(part)).collect();
                let lengths = asked * 2.0 * half / width;
                Ok(Plan { division: Division { points, weights: vec![0.0; whole] }, lengths })
            }
            InsidePattern::Voronoi { .. } => {
                let domain = self.tessellation.cell_domain(self.cell)?;
                let dimension = domain.dimension();
                let distribution =
                    pattern.diameters().expect("of cells").distribution(dimension.axes().into());
                let drawn = quantile_volumes(dimension, &distribution, whole);
                let factor = domain.measure() / drawn.iter().sum::<f64>();
                let volumes: Vec<f64> = drawn.iter().map(|volume| volume * factor).collect();
                let fraction = || unit_fraction(self.generator.next_u64());
                let seeds = place_spheres(&domain, &volumes, fraction)?;
                let diagram = PowerDiagram::with_volumes(&domain, &seeds, &volumes)
                    .and_then(|diagram| diagram.lloyd(Config::LLOYD_OF_SIZES as usize))?;
                let lengths = volumes.iter().map(|volume| dimension.ball_diameter(*volume)).sum();
                let points = diagram.tessellation().seeds().to_vec();
                Ok(Plan { division: Division { points, weights: diagram.weights().to_vec() }, lengths })
            }
        }
    }
}

/// A random direction, evenly spread over the sphere, in the plane over the circle.
fn random_direction(is_plane: bool, generator: &mut ChaCha8Rng) -> DVec3 {
    let mut fraction = || unit_fraction(generator.next_u64());
    let (sin, cos) = (std::f64::consts::TAU * fraction()).sin_cos();
    if is_plane {
        return DVec3::new(cos, sin, 0.0);
    }
    let z = 2.0 * fraction() - 1.0;
    let radius = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(radius * cos, radius * sin, z)
}

impl crate::InsideOptions {
    /// That even the largest grain is too small, which has so many parts.
    fn nothing_divided(&self, dimension: Dimension, most: f64) -> InsideError {
        let remedy = match self.pattern {
            InsidePattern::Lamellae { width, .. } => format!("width={}", two_digits_down(width * most / 2.0)),
            InsidePattern::Voronoi { diameter, .. } => {
                format!("diameter={}", two_digits_down(diameter * dimension.cube_edge(most / 1.5)))
            }
        };
        InsideError::NothingDivided { pattern: self.to_string(), remedy }
    }
}

impl Parents {
    /// Index of each grain's parent.
    pub fn parent_of(&self) -> &[usize] {
        &self.parent_of
    }

    /// What became of each pattern that was asked for.
    pub fn patterns(&self) -> &[Divided] {
        &self.patterns
    }

    /// The number of the seed of a grain's parent.
    pub(crate) fn number(&self, grain: usize) -> u32 {
        self.ids[self.parent_of[grain]]
    }

    /// What files hold of each grain's parent.
    pub(crate) fn array(&self) -> ItemTuples {
        let number = |grain: usize| [self.number(grain).cast_signed()];
        ItemTuples::new(PARENT, (0..self.parent_of.len()).map(number))
    }

    /// What grains have, added up by their parents.
    pub(crate) fn sums(&self, of_grains: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.ids.len()];
        of_grains.iter().zip(&self.parent_of).for_each(|(value, parent)| sums[*parent] += value);
        sums
    }
}

impl Divided {
    /// What the length is.
    pub(crate) fn length_name(&self) -> &'static str {
        if self.is_lamellar { "mean width of lamellae" } else { "mean diameter of parts" }
    }
}

/// Part of a line of a summary.
impl fmt::Display for Divided {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { asked, grains, divided, parts, length, .. } = self;
        let name = self.length_name();
        write!(out, "{asked}: {divided} of {grains} grains in {parts} parts, {name} {length:.4}")
    }
}
