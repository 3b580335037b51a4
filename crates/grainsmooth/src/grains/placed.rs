//! Grains of phases that have a place among the others.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use voronoi::volumes::{
    InclusionPlace, InsertedGrains, PowerDiagram, insert_grains, place_inclusions, place_spheres,
};
use voronoi::{CellId, Domain, Side, Tessellation};

use crate::memory::{available_memory, check_cells};
use crate::seeds::random::unit_fraction;
use crate::{Config, Error, GrainCells, GrainSizes};

/// The generator's stream for places, apart from those of positions (0), orientations (1, 2), sizes (3) and directions (4).
const STREAM: u64 = 5;

/// Cells for an inclusion, in memory: 23 each, where 400 are on triple lines of 60 grains.
const CELLS_OF_INCLUSION: usize = 25;

/// How often grains are tried for a change of places, for each grain. A quarter of 500 periodic grains that is to be clustered has a contiguity of 0.58, 0.64 and 0.67
/// with 10, 20 and 50 tries, and 0.69 with 200; one that is to be dispersed 0.10, 0.09, 0.09 and 0.08 (means of three seeds).
const TRIES: usize = 50;

/// How many grains next in size a grain may change places with: more change sizes, and so all cells.
const NEXT_IN_SIZE: usize = 20;

/// Cells of grains of which some are put into others.
pub(crate) struct PlacedGrains {
    pub(crate) tessellation: Tessellation,
    pub(crate) weights: Vec<f64>,
    pub(crate) grain_cells: GrainCells,
    pub(crate) centroid_steps: usize,
}

impl PlacedGrains {
    /// Packs the grains of the phases without a place of their own, and puts the others between them or inside.
    ///
    /// # Errors
    /// [`Error::NoPlace`] and [`Error::NoRoomAround`]; whatever keeps cells from having their volumes.
    pub(crate) fn new(config: &Config, domain: &Domain, sizes: &GrainSizes) -> Result<Self, Error> {
        let place_of = |grain: usize| -> Option<InclusionPlace> {
            config.phases.get(sizes.phase_of()[grain])?.place?.of_inclusions()
        };
        let volumes = sizes.volumes();
        let [matrix, inclusions]: [Vec<usize>; 2] = [false, true]
            .map(|is_put| (0..volumes.len()).filter(|grain| place_of(*grain).is_some() == is_put).collect());
        check_cells(matrix.len() + CELLS_OF_INCLUSION * inclusions.len(), available_memory())?;
        let of_matrix: Vec<f64> = matrix.iter().map(|grain| volumes[*grain]).collect();
        let factor = domain.measure() / of_matrix.iter().sum::<f64>();
        let whole: Vec<f64> = of_matrix.iter().map(|volume| volume * factor).collect();
        let mut positions = ChaCha8Rng::seed_from_u64(config.random_seed);
        let seeds = place_spheres(domain, &whole, || unit_fraction(positions.next_u64()))?;
        let diagram = PowerDiagram::with_volumes(domain, &seeds, &whole)
            .and_then(|diagram| diagram.lloyd(config.centroid_steps() as usize))?;
        let mut places = generator(config);
        let wanted: Vec<(InclusionPlace, f64)> =
            inclusions.iter().filter_map(|grain| Some((place_of(*grain)?, volumes[*grain]))).collect();
        let fraction = || unit_fraction(places.next_u64());
        let placed = place_inclusions(diagram.tessellation(), diagram.weights(), &wanted, fraction)?;
        let inserted = insert_grains(diagram.tessellation(), diagram.weights(), &of_matrix, &placed);
        let InsertedGrains { tessellation, weights, grain_of_cell, moves } =
            inserted.map_err(Error::NoRoomAround)?;
        let numbers: Vec<u32> = matrix
            .iter()
            .chain(&inclusions)
            .map(|grain| u32::try_from(*grain).expect("grain ids fit 32 bits"))
            .collect();
        let of_cell: Vec<u32> = grain_of_cell.iter().map(|grain| numbers[*grain as usize]).collect();
        Ok(Self {
            tessellation,
            weights,
            grain_cells: GrainCells::new(&of_cell, &moves, volumes.len()),
            centroid_steps: diagram.centroid_steps(),
        })
    }
}

fn generator(config: &Config) -> ChaCha8Rng {
    let mut generator = ChaCha8Rng::seed_from_u64(config.random_seed);
    generator.set_stream(STREAM);
    generator
}

/// The grain that each cell is to be, so that phases which are to be clustered or dispersed are; nothing where none is.
///
/// Two grains of different phases change places, again and again, where that makes the area between grains of a clustered phase larger, or less between those
/// of a dispersed one. Where phases share a distribution of sizes, those are alike in size.
pub(crate) fn rearranged(config: &Config, cells: &Tessellation, sizes: &GrainSizes) -> Option<Vec<usize>> {
    let signs: Vec<f64> = config
        .phases
        .iter()
        .map(|phase| match phase.place.and_then(|place| place.is_clustered()) {
            Some(true) => 1.0,
            Some(false) => -1.0,
            None => 0.0,
        })
        .collect();
    if signs.iter().all(|sign| *sign == 0.0) {
        return None;
    }
    let count = cells.cell_count();
    let contacts = contact_areas(cells, None, count);
    let mut by_size: Vec<usize> = (0..count).collect();
    by_size.sort_unstable_by(|a, b| sizes.volumes()[*a].total_cmp(&sizes.volumes()[*b]).then(a.cmp(b)));
    let reach = if config.phases_have_diameters() { count } else { NEXT_IN_SIZE };
    let mut grain_of: Vec<usize> = (0..count).collect();
    // Of a cell, if it were of a phase, and another cell of another: what it shares with its own kind.
    let gain = |phase_of: &dyn Fn(usize) -> usize, cell: usize, other: usize| -> f64 {
        let phase = phase_of(cell);
        let alike =
            contacts[cell].iter().filter(|(beside, _)| *beside != other && phase_of(*beside) == phase);
        signs[phase] * alike.map(|(_, area)| area).sum::<f64>()
    };
    let mut generator = generator(config);
    let mut below = |count: usize| -> usize {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a share of a count is one"
        )]
        let number = (unit_fraction(generator.next_u64()) * count as f64) as usize;
        number.min(count - 1)
    };
    for _ in 0..TRIES * count {
        let rank = below(count);
        let first = rank.saturating_sub(reach);
        let cell = by_size[rank];
        let other = by_size[first + below((rank + reach + 1).min(count) - first)];
        let [before, after] = [[cell, other], [other, cell]].map(|[at_cell, at_other]| {
            let phase_of = |place: usize| {
                let place = if place == cell {
                    at_cell
                } else if place == other {
                    at_other
                } else {
                    place
                };
                sizes.phase_of()[grain_of[place]]
            };
            gain(&phase_of, cell, other) + gain(&phase_of, other, cell)
        });
        if after > before {
            grain_of.swap(cell, other);
        }
    }
    Some(grain_of)
}

/// What grains share with each other grain beside them: its number and the area (in the plane: length), in order.
pub(crate) fn contact_areas(
    cells: &Tessellation,
    grains: Option<&GrainCells>,
    count: usize,
) -> Vec<Vec<(usize, f64)>> {
    let grain_of = |cell: CellId| grains.map_or(cell.index(), |grains| grains.grain(cell).index());
    let mut pairs: Vec<(usize, usize, f64)> = Vec::new();
    let primaries = cells.face_count() - cells.periodic_faces().len();
    for face in cells.faces().take(primaries) {
        let [Some((first, _)), Some((second, _))] = cells.face_sides(face).map(Side::cell) else { continue };
        let [first, second] = [first, second].map(grain_of);
        if first != second {
            let area = cells.face_area(face);
            pairs.extend([(first, second, area), (second, first, area)]);
        }
    }
    pairs.sort_by_key(|(first, second, _)| (*first, *second));
    let mut areas = vec![Vec::new(); count];
    for same in pairs.chunk_by(|one, other| (one.0, one.1) == (other.0, other.1)) {
        areas[same[0].0].push((same[0].1, same.iter().map(|pair| pair.2).sum()));
    }
    areas
}
