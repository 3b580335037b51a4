//! Power diagrams whose cells have given volumes (in the plane: areas).
//!
//! For any distinct seeds and positive volumes that add up to the domain's there are weights with which the cells have these
//! volumes, unique up to a common constant (Aurenhammer, Hoffmann and Aronov 1998). [`PowerDiagram::with_volumes`] finds them, and
//! [`PowerDiagram::lloyd`] moves seeds to the centroids of their cells, which keep their volumes. [`place_spheres`] makes seeds, and
//! [`divide_cells`] divides cells by further ones. [`GrainDiagram`] makes grains of given shapes too, each of several cells.
//!
//! ```
//! use glam::DVec3;
//! use voronoi::Domain;
//! use voronoi::volumes::PowerDiagram;
//!
//! let seeds = [DVec3::new(0.25, 0.5, 0.5), DVec3::new(0.75, 0.5, 0.5)];
//! let diagram = PowerDiagram::with_volumes(&Domain::unit_cube(), &seeds, &[0.3, 0.7])?;
//! // The face between them is at x = 0.3: (0.05^2 - w_0) = (0.45^2 - w_1).
//! assert!((diagram.weights()[1] - diagram.weights()[0] - 0.2).abs() < 1e-12);
//! assert!((diagram.tessellation().cell_measures()[0].volume - 0.3).abs() < 1e-12);
//! # Ok::<(), voronoi::volumes::VolumesError>(())
//! ```

mod division;
mod grain_diagram;
mod grains;
mod inclusions;
mod laplacian;
mod newton;
mod places;
mod shape;
mod spheres;

use std::sync::Arc;

use glam::DVec3;

use crate::{Domain, Tessellation, VoronoiError};
pub use division::{DividedCells, Division, divide_cells};
pub use grain_diagram::GrainDiagram;
use grains::Grains;
pub use inclusions::{Inclusion, InsertedGrains, insert_grains};
use newton::{Clipped, approach};
pub use places::{InclusionPlace, PlaceError, place_inclusions};
pub use shape::GrainShape;
pub use spheres::{place_ellipsoids, place_spheres};

/// By how much a grain's volume may miss its target, relative to this.
pub const TOLERANCE: f64 = 1e-10;

/// Where Newton's method stops: below it rounding decides. A step from 1e-8 leads to 1e-13 or so.
const GOAL: f64 = 1e-11;

/// How near volumes come between centroid steps: each step moves seeds, so more is lost again.
const GOAL_BETWEEN_STEPS: f64 = 0.5;

/// By how much the sum of volumes may miss the domain's, relative to it: what rounding makes of some 100 000 terms.
const SUM_TOLERANCE: f64 = 1e-11;

/// How often a centroid step is halved until no cell is empty. At cv 1 an eighth was the least that was needed.
const MOST_HALVED_STEPS: i32 = 10;

/// Why cells cannot have given volumes. Grains are named by their position in the input, counted from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VolumesError {
    /// The seeds make no tessellation.
    #[error(transparent)]
    Voronoi(#[from] VoronoiError),
    /// As many volumes as seeds are wanted.
    #[error("{volumes} volumes for {seeds} seeds; give one for each")]
    Count {
        /// Number of seeds.
        seeds: usize,
        /// Number of volumes.
        volumes: usize,
    },
    /// A volume is not positive and finite.
    #[error("grain {grain} is given the volume {volume}; it must be positive and finite")]
    BadVolume {
        /// Position of the grain in the input.
        grain: usize,
        /// Its target volume.
        volume: f64,
    },
    /// The volumes do not fill the domain, or more than that.
    #[error("the volumes add up to {sum}, but the domain {domain} has {measure}; multiply each by {}", .measure / .sum)]
    BadSum {
        /// What the target volumes add up to.
        sum: f64,
        /// Volume of the domain (in the plane: area).
        measure: f64,
        /// The domain in words.
        domain: String,
    },
    /// The cell of a seed is too thin for any volume even without weights: coordinates have too few digits.
    #[error("grain {grain} has no volume even without weights; move its seed away from its neighbours'")]
    TooNear {
        /// Position of the grain in the input.
        grain: usize,
    },
    /// A grain that others are put into comes apart.
    #[error("grain {grain} is cut into pieces by the grains inside it")]
    InPieces {
        /// The grain.
        grain: usize,
    },
    /// A volume was not reached: coordinates have too few digits for a cell that small, or that far from the origin.
    #[error(
        "grain {grain} should have the volume {target:e}, but reached {reached:e} at best; move its seed away from its neighbours', or the domain to the origin"
    )]
    NotReached {
        /// Position of the grain in the input.
        grain: usize,
        /// Its target volume.
        target: f64,
        /// Its volume.
        reached: f64,
    },
}

/// Power cells of given volumes.
#[derive(Debug, Clone, PartialEq)]
pub struct PowerDiagram {
    tessellation: Tessellation,
    weights: Vec<f64>,
    volumes: Vec<f64>,
    centroid_steps: usize,
    newton_steps: usize,
}

impl PowerDiagram {
    /// The power diagram of the seeds whose cells have the given volumes, each within [`TOLERANCE`]. In the plane the seeds' z must be
    /// 0 and volumes are areas.
    ///
    /// Newton's method on the cube roots of volumes (in the plane: square roots), in which a cell's size is nearly linear in its
    /// weight, so that volumes may differ by factors of 1e6 (after Kitagawa, Merigot and Thibert 2019, who take volumes). It begins with
    /// the spheres of [`place_spheres`]. The same input gives the same result bit by bit whatever the number of threads.
    ///
    /// ```
    /// use glam::DVec3;
    /// use voronoi::Domain;
    /// use voronoi::volumes::PowerDiagram;
    ///
    /// let seeds = [DVec3::new(0.3, 0.5, 0.5), DVec3::new(0.6, 0.4, 0.5), DVec3::new(0.7, 0.7, 0.2)];
    /// let cells = PowerDiagram::with_volumes(&Domain::unit_cube(), &seeds, &[0.5, 0.3, 0.2])?;
    /// let measures = cells.tessellation().cell_measures();
    /// assert!(measures.iter().zip([0.5, 0.3, 0.2]).all(|(cell, wanted)| (cell.volume - wanted).abs() < 1e-9));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`VolumesError`] for a bad seed, as [`Tessellation::new`]; for a count that differs, a volume that is not positive and volumes
    /// that do not add up to the domain's; for seeds so near to one another that rounding decides.
    pub fn with_volumes(domain: &Domain, seeds: &[DVec3], volumes: &[f64]) -> Result<Self, VolumesError> {
        if seeds.len() != volumes.len() {
            return Err(VolumesError::Count { seeds: seeds.len(), volumes: volumes.len() });
        }
        let volumes = check_volumes(domain, volumes)?;
        let radius = |volume: &f64| spheres::sphere_radius(domain.dimension(), *volume);
        let mut weights: Vec<f64> = volumes.iter().map(|volume| radius(volume).powi(2)).collect();
        let smallest = weights.iter().copied().fold(f64::INFINITY, f64::min);
        weights.iter_mut().for_each(|weight| *weight -= smallest);
        let mut state = first(domain, seeds, weights, &Grains::of_single_cells(seeds.len()))?;
        let newton_steps = approach(&mut state, &volumes, GOAL)?;
        Ok(Self { newton_steps, ..Self::finished(state, volumes) })
    }

    /// Moves each seed to the centroid of its cell, with new weights that keep the volumes, and does so again and again. Cells grow
    /// rounder: 10 steps give 2000 cells of cv 0.35 on average 13.7 faces, as measured metals have; many more make them too regular.
    ///
    /// Seeds move part of the way where a cell would be empty otherwise. Where even a 512th of the way leaves one empty, the steps end
    /// early: [`Self::centroid_steps`] tells how many were done.
    ///
    /// ```
    /// use glam::DVec3;
    /// use voronoi::Domain;
    /// use voronoi::volumes::PowerDiagram;
    ///
    /// let seeds = [DVec3::new(0.3, 0.5, 0.5), DVec3::new(0.6, 0.4, 0.5), DVec3::new(0.7, 0.7, 0.2)];
    /// let cells = PowerDiagram::with_volumes(&Domain::unit_cube(), &seeds, &[0.5, 0.3, 0.2])?.lloyd(5)?;
    /// assert_eq!(cells.centroid_steps(), 5);
    /// assert!((cells.tessellation().cell_measures()[2].volume - 0.2).abs() < 1e-9, "volumes stay");
    /// # Ok::<(), voronoi::volumes::VolumesError>(())
    /// ```
    ///
    /// # Errors
    /// [`VolumesError::NotReached`], as [`Self::with_volumes`].
    pub fn lloyd(self, steps: usize) -> Result<Self, VolumesError> {
        let Self { tessellation, weights, volumes, mut centroid_steps, newton_steps } = self;
        let grains = Grains::of_single_cells(weights.len());
        let mut state = Clipped::of(tessellation, weights, grains);
        for _ in 0..steps {
            let moved = (0..MOST_HALVED_STEPS).find_map(|halvings| {
                let mut moved = state.moved(0.5f64.powi(halvings)).ok()?;
                let is_good =
                    !moved.has_empty() && approach(&mut moved, &volumes, GOAL_BETWEEN_STEPS).is_ok();
                is_good.then_some(moved)
            });
            let Some(moved) = moved else { break };
            state = moved;
            centroid_steps += 1;
        }
        approach(&mut state, &volumes, GOAL)?;
        Ok(Self { centroid_steps, newton_steps, ..Self::finished(state, volumes) })
    }

    fn finished(Clipped { tessellation, weights, .. }: Clipped, volumes: Vec<f64>) -> Self {
        Self { tessellation, weights, volumes, centroid_steps: 0, newton_steps: 0 }
    }

    /// The cells. Their seeds are those of the input until [`Self::lloyd`] moves them.
    pub fn tessellation(&self) -> &Tessellation {
        &self.tessellation
    }

    /// The weights, with which [`Tessellation::power`] gives the same cells, bit for bit; their mean is 0.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// How many times seeds moved to the centroids of their cells.
    pub fn centroid_steps(&self) -> usize {
        self.centroid_steps
    }

    /// How many steps of Newton's method the first weights took.
    pub fn newton_steps(&self) -> usize {
        self.newton_steps
    }

    /// The target volumes, by grain.
    pub fn volumes(&self) -> &[f64] {
        &self.volumes
    }
}

/// Cells of some weights; where that leaves a grain empty, of weights that differ less, in the end not at all.
fn first(
    domain: &Domain,
    seeds: &[DVec3],
    mut weights: Vec<f64>,
    grains: &Arc<Grains>,
) -> Result<Clipped, VolumesError> {
    for is_last in (0..20).map(|halvings| halvings == 19) {
        if is_last {
            weights.fill(0.0);
        }
        let state = Clipped::new(domain, seeds, weights.clone(), Arc::clone(grains))?;
        if !state.has_empty() {
            return Ok(state);
        }
        if let Some(grain) = state.volumes().position(|volume| volume <= 0.0).filter(|_| is_last) {
            return Err(VolumesError::TooNear { grain });
        }
        weights.iter_mut().for_each(|weight| *weight *= 0.5);
    }
    unreachable!("the last round returns")
}

/// The volumes, which are multiplied to fill the domain to the last digit.
fn check_volumes(domain: &Domain, volumes: &[f64]) -> Result<Vec<f64>, VolumesError> {
    let is_good = |volume: f64| volume.is_finite() && volume > 0.0;
    if let Some((grain, volume)) = volumes.iter().enumerate().find(|(_, volume)| !is_good(**volume)) {
        return Err(VolumesError::BadVolume { grain, volume: *volume });
    }
    if volumes.is_empty() {
        return Err(VoronoiError::NoSeeds.into());
    }
    let (sum, measure) = (volumes.iter().sum::<f64>(), domain.measure());
    if (sum - measure).abs() > SUM_TOLERANCE * measure || sum.is_infinite() {
        return Err(VolumesError::BadSum { sum, measure, domain: domain.to_string() });
    }
    Ok(volumes.iter().map(|volume| volume * (measure / sum)).collect())
}
