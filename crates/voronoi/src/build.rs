//! From seeds to the cell complex.

mod cell_edges;
mod cell_sums;
mod merge;
mod periodic_merge;
mod planar_cells;
mod planar_merge;
mod planar_squares;
pub(crate) mod stream;
mod tile;
mod tile_faces;
mod tile_vertex;
mod vertex_numbers;

use glam::DVec3;

use crate::exact::generator::Generator;
use crate::sites::search::Search;
use crate::{Dimension, Domain, Tessellation, VoronoiError};
use merge::merge;
use periodic_merge::merge_periodic;
use planar_cells::tessellate;
use tile::cut_tiles;

impl Tessellation {
    /// Cuts the domain into the Voronoi cells of the seeds, in parallel. In the plane the seeds' z must be 0.
    ///
    /// The same seeds give the same result bit by bit whatever the number of threads.
    ///
    /// # Errors
    /// [`VoronoiError`] names the first seed that is not finite, outside the domain or a duplicate.
    pub fn new(domain: &Domain, seeds: &[DVec3]) -> Result<Self, VoronoiError> {
        Self::cut(domain, seeds, None)
    }

    /// Cuts the domain into the power (Laguerre) cells of the seeds: a point belongs to the seed s with the smallest
    /// `|x - s|^2 - w`. The weight w is the squared radius of a sphere around the seed.
    ///
    /// A seed whose neighbours outweigh it has no cell; [`Self::empty_cells`] lists those.
    ///
    /// ```
    /// use glam::DVec3;
    /// use voronoi::{Domain, Tessellation};
    ///
    /// let seeds = [DVec3::new(0.25, 0.5, 0.5), DVec3::new(0.75, 0.5, 0.5)];
    /// // The wall between two seeds moves by the difference of their weights over twice their distance.
    /// let cells = Tessellation::power(&Domain::unit_cube(), &seeds, &[0.1, 0.0])?;
    /// assert!((cells.cell_measures()[0].volume - 0.6).abs() < 1e-12);
    /// # Ok::<(), voronoi::VoronoiError>(())
    /// ```
    ///
    /// # Errors
    /// As [`Self::new`]; [`VoronoiError::BadWeight`] for a weight that is not finite.
    ///
    /// # Panics
    /// When there are not as many weights as seeds.
    pub fn power(domain: &Domain, seeds: &[DVec3], weights: &[f64]) -> Result<Self, VoronoiError> {
        Self::cut(domain, seeds, Some(weights))
    }

    fn cut(domain: &Domain, seeds: &[DVec3], weights: Option<&[f64]>) -> Result<Self, VoronoiError> {
        check(domain, seeds, weights)?;
        let is_plain = weights.is_none() && !domain.is_periodic() && domain.is_box();
        if is_plain
            && domain.dimension() == Dimension::Two
            && let Some(tessellation) = tessellate(domain, seeds)
        {
            return Ok(tessellation);
        }
        let mut search = Search::new(domain, seeds, weights)?;
        Ok(if domain.is_periodic() {
            let tiles = cut_tiles(&mut search)?;
            merge_periodic(&search, seeds, tiles)
        } else {
            merge(&search, seeds)
        })
    }
}

/// Whether seeds have cells.
///
/// # Panics
/// When there are weights, but not as many as seeds.
fn check(domain: &Domain, seeds: &[DVec3], weights: Option<&[f64]>) -> Result<(), VoronoiError> {
    if let Some(weights) = weights {
        assert_eq!(seeds.len(), weights.len(), "one weight for each seed");
        if let Some((seed, weight)) = weights.iter().enumerate().find(|(_, weight)| !weight.is_finite()) {
            return Err(VoronoiError::BadWeight { seed, weight: *weight });
        }
    }
    if seeds.is_empty() {
        return Err(VoronoiError::NoSeeds);
    }
    if seeds.len() > Generator::MAX_SITES {
        return Err(VoronoiError::TooManySeeds { count: seeds.len() });
    }
    for (seed, &position) in seeds.iter().enumerate() {
        if !position.is_finite() {
            return Err(VoronoiError::NotFinite { seed, position });
        }
        if !domain.contains(position) {
            return Err(VoronoiError::OutsideDomain { seed, position, domain: domain.to_string() });
        }
    }
    Ok(())
}
