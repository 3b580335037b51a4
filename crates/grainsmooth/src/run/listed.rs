//! Cells alone, one by one, where nothing asks for the complex that they make up.

use glam::DVec3;
use voronoi::{CellStream, Dimension, Domain, Tessellation};

use super::given::grains_called;
use super::stage::{Clock, Progress, Stage};
use super::tessellated::{NumberedSeeds, located, seeds};
use crate::memory::check_listed_cells;
use crate::{BoundaryLaw, Config, Error, FileSeeds, GrainAttributes, SeedSource};

/// The cells of a config's seeds without the complex that they make up.
#[derive(Debug)]
pub struct ListedCells {
    /// What is divided up.
    pub domain: Domain,
    /// All cells; none is empty.
    pub cells: CellStream,
    /// Power weight of each seed, where there are radii.
    pub weights: Option<Vec<f64>>,
    /// The numbers of the seeds.
    pub grains: GrainAttributes,
    /// As of [`Tessellated::passed_over`](crate::Tessellated::passed_over).
    pub passed_over: Option<&'static str>,
}

impl Config {
    /// Whether the config's cells are known without their complex: in space, of seeds that are used as they are, and that nothing but a table is made of.
    pub fn lists_cells(&self) -> bool {
        self.dimension == Dimension::Three
            && !self.is_sized()
            && self.centroid_steps() == 0
            && self.min_diameter == 0.0
            && !self.drop_empty
            && self.inside.is_empty()
            && !self.has_texture()
            && self.stretch() == DVec3::ONE
    }
}

/// Computes the cells of a config that [lists](Config::lists_cells) them: some 220 bytes each instead of 1600.
///
/// # Errors
/// As of [`tessellate`](crate::tessellate).
pub fn list_cells(config: &Config, progress: Progress<'_>) -> Result<ListedCells, Error> {
    config.check()?;
    let mut clock = Clock { progress, times: Vec::new() };
    let domain = config.domain()?;
    let (FileSeeds { seeds, passed_over }, _) =
        clock.time(Stage::Seeds, || seeds(config, &domain, check_listed_cells))?;
    let NumberedSeeds { mut seeds, ids } = NumberedSeeds::new(seeds);
    let positions: Vec<DVec3> = seeds.iter().map(|seed| seed.position).collect();
    let has_weights = seeds.iter().any(|seed| seed.weight.is_some());
    let weights: Option<Vec<f64>> =
        has_weights.then(|| seeds.iter().map(|seed| seed.weight.unwrap_or(0.0)).collect());
    if !matches!(config.seeds, SeedSource::File(_)) {
        // Only lines of files are told of where something is wrong.
        seeds = Vec::new();
    }
    let cells = clock.time(Stage::Cells, || {
        Tessellation::stream(&domain, &positions, weights.as_deref())
            .map_err(|error| located(error, config, &seeds))
    })?;
    let numbered = (0u32..).zip(cells.measures());
    let empty: Vec<u32> =
        numbered.filter(|(_, measure)| measure.face_count == 0).map(|(cell, _)| cell).collect();
    if !empty.is_empty() {
        return Err(Error::EmptyGrains { grains: empty });
    }
    // Whether boundaries can have what is asked for, as where they are made.
    BoundaryLaw::new(config, None, None, ids.len())?;
    Ok(ListedCells { domain, cells, weights, grains: grains_called(ids), passed_over })
}
