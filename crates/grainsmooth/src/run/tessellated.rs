//! From a config to its seeds and flat cells.

use std::time::Duration;

use glam::DVec3;
use polycrystal::{FaceMesh, GrainId, Junctions, Network, NetworkError};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use voronoi::volumes::{
    GrainDiagram, GrainShape, PowerDiagram, VolumesError, place_ellipsoids, place_spheres,
};
use voronoi::{CellId, Domain, Side, Tessellation, VoronoiError};

use super::stage::{Clock, Progress, Stage};
use crate::grains::gradient::Gradient;
use crate::grains::inner::InnerGrains;
use crate::grains::placed::{PlacedGrains, rearranged};
use crate::memory::{MemoryError, available_memory, check_cells};
use crate::seeds::count::seed_count;
use crate::seeds::random::unit_fraction;
use crate::{
    BoundaryLaw, Config, EquivalentDiameters, Error, FileSeed, FileSeeds, GrainAttributes, GrainCells,
    GrainPhases, GrainShapes, GrainSizes, GrainTexture, SeedPlace, SeedSource, poisson_disc_seeds,
    random_seeds, read_seed_file,
};

/// The cells of a config's seeds.
#[derive(Debug, Clone, PartialEq)]
pub struct Tessellated {
    /// All cells; none is empty.
    pub tessellation: Tessellation,
    /// Power weight of each seed: 0 where there are no radii, and no grains are divided.
    pub weights: Vec<f64>,
    /// What is known of each grain.
    pub grains: GrainAttributes,
    /// The numbers of seeds that are left out because their neighbours outweigh them.
    pub dropped_seeds: Vec<u32>,
    /// The numbers of seeds that are left out because their cells were below [`Config::min_diameter`].
    pub merged_seeds: Vec<u32>,
    /// The volumes that grains were to have, where these are given: of those that others are parts of.
    pub sizes: Option<GrainSizes>,
    /// The grain of each cell, where grains are of several cells; without, each cell is a grain.
    pub grain_cells: Option<GrainCells>,
    /// The shapes of the grains, where some are asked for.
    pub shapes: Option<GrainShapes>,
    /// What boundaries have.
    pub law: BoundaryLaw,
    /// What the file of the seeds also tells of grains, and has no place here.
    pub passed_over: Option<&'static str>,
    /// Time that each stage took.
    pub times: Vec<(Stage, Duration)>,
}

impl Tessellated {
    /// The cells as [`Config::aspect_ratio`] stretches them.
    #[must_use]
    pub fn stretched(mut self, config: &Config) -> Self {
        self.stretch(config.stretch());
        self
    }

    /// Makes the axes of the cells so many times as long.
    pub(crate) fn stretch(&mut self, stretch: DVec3) {
        if stretch != DVec3::ONE {
            self.tessellation = self.tessellation.stretched(stretch);
        }
    }

    /// The cells with rounder shapes of the grains that led to no network, where shapes are asked for and some are no balls yet.
    ///
    /// # Errors
    /// As of [`GrainDiagram::rounder`].
    pub(crate) fn with_rounder(&self, grains: &[GrainId]) -> Result<Option<Self>, VolumesError> {
        let Some(shapes) = &self.shapes else { return Ok(None) };
        let Some(rounder) = shapes.with_rounder(grains)? else { return Ok(None) };
        let diagram = rounder.diagram();
        let (tessellation, weights) = (diagram.tessellation().clone(), diagram.weights().to_vec());
        let grain_cells = Some(rounder.grain_cells());
        Ok(Some(Self { tessellation, weights, grain_cells, shapes: Some(rounder), ..self.clone() }))
    }

    /// Number of grains.
    pub(crate) fn grain_count(&self) -> usize {
        self.grain_cells.as_ref().map_or_else(|| self.tessellation.cell_count(), GrainCells::count)
    }

    /// Volumes of the grains in the flat cells; in the plane areas.
    pub(crate) fn volumes(&self) -> Vec<f64> {
        grain_volumes(&self.tessellation, self.grain_cells.as_ref())
    }

    /// Centroids of the grains in the flat cells.
    pub(crate) fn centroids(&self) -> Vec<DVec3> {
        let Some(grains) = &self.grain_cells else { return self.tessellation.centroids() };
        let cells = self.tessellation.cell_measures();
        let domain = self.tessellation.domain();
        let centroids = cells.iter().zip(grains.parts());
        let sums = grains
            .sums(centroids.map(|(cell, part)| cell.volume * (cell.centroid + part.moved.vector(domain))));
        sums.into_iter().zip(self.volumes()).map(|(sum, volume)| sum / volume).collect()
    }

    /// Number of faces of each grain in some cells, those of this or what regularisation made of them.
    pub(crate) fn face_counts(&self, tessellation: &Tessellation) -> Vec<usize> {
        let cells = (0u32..).take(tessellation.cell_count()).map(CellId);
        match &self.grain_cells {
            Some(grains) => grains.face_counts(tessellation),
            None => cells.map(|cell| tessellation.cell_faces(cell).len()).collect(),
        }
    }

    /// The network of the grains of some cells, those of this or what regularisation made of them.
    pub(crate) fn network(
        &self,
        tessellation: &Tessellation,
        face_mesh: FaceMesh,
        junctions: Junctions,
        coarsening: f64,
        levels: usize,
    ) -> Result<(Network, Vec<DVec3>), NetworkError> {
        match &self.grain_cells {
            Some(grains) => {
                Network::of_grains(tessellation, grains.parts(), face_mesh, junctions, coarsening, levels)
            }
            None => Network::with_face_mesh(tessellation, face_mesh, junctions, levels),
        }
    }
}

/// Volumes of the grains that cells make up; in the plane areas.
pub(crate) fn grain_volumes(tessellation: &Tessellation, grains: Option<&GrainCells>) -> Vec<f64> {
    let cells = tessellation.cell_measures().into_iter().map(|cell| cell.volume);
    match grains {
        Some(grains) => grains.sums(cells),
        None => cells.collect(),
    }
}

/// Computes the cells alone.
///
/// ```
/// use grainsmooth::{Config, SeedSource, smooth, tessellate};
///
/// let config = Config { seeds: SeedSource::Random { count: 10 }, levels: 0, ..Config::default() };
/// let cells = tessellate(&config, &|_, _, _| ())?;
/// let volumes: f64 = cells.tessellation.cell_measures().iter().map(|cell| cell.volume).sum();
/// assert!((volumes - 1.0).abs() < 1e-12);
/// // The second half of `make_polycrystal`.
/// let polycrystal = smooth(&config, cells, &|_, _, _| ())?;
/// assert!(polycrystal.validation.is_good());
/// # Ok::<(), grainsmooth::Error>(())
/// ```
///
/// # Errors
/// [`Error::Config`] where options do not go together; whatever is wrong with the seeds; [`Error::EmptyGrains`] unless the config drops them.
pub fn tessellate(config: &Config, progress: Progress) -> Result<Tessellated, Error> {
    config.check()?;
    let mut clock = Clock { progress, times: Vec::new() };
    let domain = config.domain()?;
    let (textures, histogram) = (config.textures()?, config.texture.histogram()?);
    let gradient = Gradient::of_config(config)?;
    let (FileSeeds { mut seeds, passed_over }, mut sizes) =
        clock.time(Stage::Seeds, || seeds(config, &domain, check_cells))?;
    if let Some(gradient) = gradient
        && let Some(drawn) = sizes.take()
    {
        if !matches!(config.seeds, SeedSource::File(_)) {
            seeds.iter_mut().for_each(|seed| seed.position = gradient.moved(seed.position));
        }
        let factors = seeds.iter().map(|seed| gradient.volume_factor(seed.position)).collect();
        sizes = Some(drawn.with_factors(factors));
    }
    let mut seeds = NumberedSeeds::new(seeds);
    let (mut dropped_seeds, mut merged_seeds) = (Vec::new(), Vec::new());
    let (mut grain_cells, mut shapes) = (None, None);
    let (tessellation, weights) = clock.time(Stage::Cells, || {
        if let Some(mut wanted) = sizes.take() {
            if config.has_inclusions() {
                let placed = PlacedGrains::new(config, &domain, &wanted)?;
                seeds.ids = (0u32..).take(wanted.volumes().len()).collect();
                sizes = Some(wanted.with_centroid_steps(placed.centroid_steps));
                grain_cells = Some(placed.grain_cells);
                return Ok((placed.tessellation, placed.weights));
            }
            if let Some(wanted_shapes) = config.wanted_shapes(seeds.seeds.len())? {
                let diagram = shaped_grains(config, &domain, &seeds.seeds, wanted.volumes(), &wanted_shapes)?;
                sizes = Some(wanted.with_centroid_steps(diagram.centroid_steps()));
                let asked = config.grain_shapes.as_ref().map_or_else(String::new, ToString::to_string);
                let cells = (diagram.tessellation().clone(), diagram.weights().to_vec());
                let made = GrainShapes::of_diagram(asked, wanted_shapes, diagram);
                grain_cells = Some(made.grain_cells());
                shapes = Some(made);
                return Ok(cells);
            }
            let mut diagram = sized_cells(config, &domain, &seeds.seeds, wanted.volumes())?;
            if let Some(order) = rearranged(config, diagram.tessellation(), &wanted) {
                wanted = wanted.in_order(&order);
                let places = diagram.tessellation().seeds();
                seeds.seeds.iter_mut().zip(places).for_each(|(seed, place)| seed.position = *place);
                diagram = sized_cells(config, &domain, &seeds.seeds, wanted.volumes())?;
            }
            sizes = Some(wanted.with_centroid_steps(diagram.centroid_steps()));
            return Ok((diagram.tessellation().clone(), diagram.weights().to_vec()));
        }
        let mut all = cells_of(config, &domain, &seeds.seeds)?;
        for step in 1..=config.centroid_steps() {
            seeds.seeds.iter_mut().zip(all.0.lloyd_step()).for_each(|(seed, moved)| seed.position = moved);
            all = cells_of(config, &domain, &seeds.seeds)?;
            progress(Stage::Cells, step as usize, config.centroid_steps() as usize);
        }
        let empty = all.0.empty_cells();
        if !empty.is_empty() {
            if !config.drop_empty {
                return Err(Error::EmptyGrains { grains: empty.iter().map(|cell| cell.0).collect() });
            }
            dropped_seeds = seeds.without(&empty);
            all = cells_of(config, &domain, &seeds.seeds)?;
        }
        loop {
            let small = small_cells(&all.0, config.min_diameter);
            if small.is_empty() {
                break;
            }
            merged_seeds.extend(seeds.without(&small));
            all = cells_of(config, &domain, &seeds.seeds)?;
        }
        merged_seeds.sort_unstable();
        Ok::<_, Error>(all)
    })?;
    let mut phases = sizes
        .as_ref()
        .and_then(|sizes| GrainPhases::new(config, sizes))
        .map(|phases| phases.among(&tessellation, grain_cells.as_ref()));
    let mut cells = (tessellation, weights, seeds.ids, None);
    if !config.inside.is_empty() {
        cells = clock.time(Stage::Cells, || {
            let (tessellation, weights, ids, _) = cells;
            let phase_of =
                phases.as_ref().map_or_else(|| vec![0; ids.len()], |phases| phases.phase_of().to_vec());
            let inner = InnerGrains::new(config, &tessellation, &weights, &phase_of, ids)?;
            let InnerGrains { tessellation, weights, parents } = inner;
            phases = phases.take().map(|phases| phases.of_parts(parents.parent_of()));
            let ids = (0u32..).take(tessellation.cell_count()).collect();
            Ok::<_, Error>((tessellation, weights, ids, Some(parents)))
        })?;
    }
    let (tessellation, weights, ids, parents) = cells;
    let texture = (!textures.is_empty()).then(|| {
        let volumes = grain_volumes(&tessellation, grain_cells.as_ref());
        let texture_of =
            phases.as_ref().map_or_else(|| vec![0; volumes.len()], |phases| phases.phase_of().to_vec());
        GrainTexture::draw(textures, texture_of, &volumes, config.random_seed).with_target(histogram)
    });
    let law = BoundaryLaw::new(config, phases.as_ref(), texture.as_ref(), ids.len())?;
    let times = clock.times;
    Ok(Tessellated {
        tessellation,
        weights,
        grains: GrainAttributes {
            ids,
            parents,
            phases,
            symmetry: config.texture.symmetry,
            texture,
            measured: None,
        },
        dropped_seeds,
        merged_seeds,
        sizes,
        grain_cells,
        shapes,
        law,
        passed_over,
        times,
    })
}

/// Seeds with the numbers that they had among all.
pub(super) struct NumberedSeeds {
    pub(super) seeds: Vec<FileSeed>,
    pub(super) ids: Vec<u32>,
}

impl NumberedSeeds {
    pub(super) fn new(seeds: Vec<FileSeed>) -> Self {
        Self { ids: (0u32..).zip(&seeds).map(|(number, seed)| seed.id.unwrap_or(number)).collect(), seeds }
    }

    /// Takes the seeds of some cells out, and returns their numbers.
    fn without(&mut self, cells: &[CellId]) -> Vec<u32> {
        let mut is_kept = vec![true; self.seeds.len()];
        cells.iter().for_each(|cell| is_kept[cell.index()] = false);
        let numbers = cells.iter().map(|cell| self.ids[cell.index()]).collect();
        let mut kept = is_kept.iter();
        self.seeds.retain(|_| *kept.next().unwrap_or(&true));
        let mut kept = is_kept.iter();
        self.ids.retain(|_| *kept.next().unwrap_or(&true));
        numbers
    }
}

/// The cells to take out next: those below a share of the mean equivalent diameter, of neighbours the smallest.
///
/// When these are gone the others are as they were, or have grown. So in the end the same cells are left as if the smallest of all
/// had gone each time.
fn small_cells(cells: &Tessellation, share: f64) -> Vec<CellId> {
    if share == 0.0 {
        return Vec::new();
    }
    let dimension = cells.domain().dimension();
    let diameters: Vec<f64> =
        cells.cell_measures().iter().map(|cell| dimension.ball_diameter(cell.volume)).collect();
    let limit = share * EquivalentDiameters::new(dimension, &diameters).mean;
    let is_smaller =
        |a: CellId, b: CellId| diameters[a.index()].total_cmp(&diameters[b.index()]).then(a.cmp(&b)).is_lt();
    let is_smallest = |cell: &CellId| {
        diameters[cell.index()] < limit
            && cells
                .neighbors(*cell)
                .into_iter()
                .filter_map(Side::cell)
                .all(|(other, _)| !is_smaller(other, *cell))
    };
    (0u32..).map(CellId).take(diameters.len()).filter(is_smallest).collect()
}

/// The cells of some seeds, and the seeds' weights.
fn cells_of(config: &Config, domain: &Domain, seeds: &[FileSeed]) -> Result<(Tessellation, Vec<f64>), Error> {
    let positions: Vec<DVec3> = seeds.iter().map(|seed| seed.position).collect();
    let weights: Vec<f64> = seeds.iter().map(|seed| seed.weight.unwrap_or(0.0)).collect();
    let tessellation = if seeds.iter().any(|seed| seed.weight.is_some()) {
        Tessellation::power(domain, &positions, &weights)
    } else {
        Tessellation::new(domain, &positions)
    };
    Ok((tessellation.map_err(|error| located(error, config, seeds))?, weights))
}

/// Cells of given volumes, after the centroid steps.
fn sized_cells(
    config: &Config,
    domain: &Domain,
    seeds: &[FileSeed],
    volumes: &[f64],
) -> Result<PowerDiagram, Error> {
    let positions: Vec<DVec3> = seeds.iter().map(|seed| seed.position).collect();
    let diagram = PowerDiagram::with_volumes(domain, &positions, volumes)
        .and_then(|diagram| diagram.lloyd(config.centroid_steps() as usize));
    diagram.map_err(|error| of_volumes(error, config, seeds))
}

/// Grains of given volumes and shapes, after the centroid steps.
fn shaped_grains(
    config: &Config,
    domain: &Domain,
    seeds: &[FileSeed],
    volumes: &[f64],
    shapes: &[GrainShape],
) -> Result<GrainDiagram, Error> {
    let positions: Vec<DVec3> = seeds.iter().map(|seed| seed.position).collect();
    let diagram = GrainDiagram::with_shapes(domain, &positions, volumes, shapes)
        .and_then(|diagram| diagram.lloyd(config.centroid_steps() as usize));
    diagram.map_err(|error| of_volumes(error, config, seeds))
}

/// The seeds, and the volumes that their cells are to have where these are given, if `check` finds memory for so many cells.
pub(super) fn seeds(
    config: &Config,
    domain: &Domain,
    check: fn(usize, u64) -> Result<(), MemoryError>,
) -> Result<(FileSeeds, Option<GrainSizes>), Error> {
    if let Some(count) = seed_count(config) {
        check(count, available_memory())?;
    }
    let sizes = |count| config.is_sized().then(|| GrainSizes::draw(config, domain, count)).transpose();
    let (positions, sizes) = match &config.seeds {
        SeedSource::File(path) => {
            let mut found = read_seed_file(path, config.dimension)?;
            let stretch = config.stretch();
            if stretch != DVec3::ONE {
                found.seeds.iter_mut().for_each(|seed| seed.position /= stretch);
            }
            let sizes = sizes(found.seeds.len())?;
            if sizes.is_some() && found.seeds.iter().any(|seed| seed.weight.is_some()) {
                found.seeds.iter_mut().for_each(|seed| seed.weight = None);
                found.passed_over = Some("radii or weights, as grains have other sizes,");
            }
            return Ok((found, sizes));
        }
        SeedSource::Packed { count } => {
            let sizes = GrainSizes::draw(config, domain, *count)?;
            if config.has_inclusions() {
                // Their places are known with the cells.
                return Ok((FileSeeds { seeds: Vec::new(), passed_over: None }, Some(sizes)));
            }
            let mut generator = ChaCha8Rng::seed_from_u64(config.random_seed);
            let fraction = || unit_fraction(generator.next_u64());
            let places = match config.wanted_shapes(*count)? {
                Some(shapes) => place_ellipsoids(domain, sizes.volumes(), &shapes, fraction)?,
                None => place_spheres(domain, sizes.volumes(), fraction)?,
            };
            (places, Some(sizes))
        }
        SeedSource::Random { count } => (random_seeds(*count, domain, config.random_seed), sizes(*count)?),
        SeedSource::PoissonDisc { count } => {
            (poisson_disc_seeds(*count, domain, config.random_seed), sizes(*count)?)
        }
        SeedSource::Lattice { lattice, cells } => {
            let seeds = config.lattice_seeds(*lattice, *cells, domain);
            if seeds.is_empty() {
                return Err(Error::NoLatticeSeeds { more: cells.saturating_mul(4) });
            }
            let sizes = sizes(seeds.len())?;
            (seeds, sizes)
        }
    };
    let numbered = (1..).map(SeedPlace::Entry).zip(positions);
    let seeds = numbered.map(|(place, position)| FileSeed { position, weight: None, id: None, place });
    Ok((FileSeeds { seeds: seeds.collect(), passed_over: None }, sizes))
}

fn of_volumes(error: VolumesError, config: &Config, seeds: &[FileSeed]) -> Error {
    match error {
        VolumesError::Voronoi(error) => located(error, config, seeds),
        error => error.into(),
    }
}

/// The error with the line of the seed file that it comes from.
pub(super) fn located(error: VoronoiError, config: &Config, seeds: &[FileSeed]) -> Error {
    let SeedSource::File(path) = &config.seeds else { return error.into() };
    let seed = match &error {
        VoronoiError::NotFinite { seed, .. }
        | VoronoiError::OutsideDomain { seed, .. }
        | VoronoiError::BadWeight { seed, .. } => *seed,
        VoronoiError::DuplicateSeeds { first, second, position } => {
            let places = [seeds[*first].place, seeds[*second].place];
            return Error::DuplicateSeedsInFile { path: path.clone(), places, position: *position };
        }
        _ => return error.into(),
    };
    Error::SeedInFile { path: path.clone(), place: seeds[seed].place, cause: error }
}
