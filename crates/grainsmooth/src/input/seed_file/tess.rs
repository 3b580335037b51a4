//! Seeds from Neper's tessellation files, whose cells must be those of the seeds.

use glam::{BVec3, DVec3};
use voronoi::{Dimension, Domain, Tessellation, VoronoiError};

use super::{FileDomain, FileSeed, FileSeeds, SeedPlace, SeedProblem};
use crate::{Tess, TessProblem, read_tess};

/// How far a cell's volume in the file may differ from that of the cell that its seed makes, as a share of it. Neper writes 12 digits.
const VOLUME_TOLERANCE: f64 = 1e-6;

type Located<T> = Result<T, (SeedPlace, SeedProblem)>;

/// The seeds of a file, whose cells were found to be those of its seeds.
pub(super) fn seeds(content: &[u8]) -> Located<FileSeeds> {
    let tess = read(content)?;
    let seeds: Vec<FileSeed> = (1..)
        .zip(&tess.seeds)
        .map(|(number, seed)| FileSeed {
            position: seed.position,
            weight: Some(seed.radius * seed.radius),
            id: tess.ids.get(number - 1).copied(),
            place: SeedPlace::Entry(number),
        })
        .collect();
    if seeds.is_empty() {
        return Err(problem("the cells have no seeds; give a file with *seed, as Neper writes them"));
    }
    check_cells(&tess, &domain_of(&tess)?)?;
    Ok(FileSeeds { seeds, passed_over: tess.has_orientations.then_some("orientations") })
}

/// What the cells of a file fill.
pub(super) fn domain(content: &[u8]) -> Located<FileDomain> {
    domain_of(&read(content)?)
}

fn read(content: &[u8]) -> Located<Tess> {
    let text = std::str::from_utf8(content).map_err(|error| {
        let line = 1 + content[..error.valid_up_to()].iter().filter(|&&byte| byte == b'\n').count();
        (SeedPlace::Line(line), SeedProblem::NotUtf8)
    })?;
    read_tess(text).map_err(|TessProblem { line, what }| (SeedPlace::Line(line), SeedProblem::Tess { what }))
}

fn domain_of(tess: &Tess) -> Located<FileDomain> {
    let domain = &tess.domain;
    let kind = if tess.dimension == Dimension::Two { "square" } else { "cube" };
    if domain.kind != kind {
        let is = if domain.kind.is_empty() { "missing".to_owned() } else { format!("a {}", domain.kind) };
        return Err(problem(format!("the domain is {is}; give a file whose domain is a {kind} (any box)")));
    }
    if domain.lower != DVec3::ZERO {
        let at = domain.lower;
        return Err(problem(format!("the domain begins at {at}; move it, so that it begins at 0")));
    }
    Ok(FileDomain {
        dimension: tess.dimension,
        box_size: if tess.dimension == Dimension::Two { domain.upper.with_z(1.0) } else { domain.upper },
        periodic: tess.periodicity.as_ref().map_or(BVec3::FALSE, |periodicity| periodicity.axes.into()),
    })
}

/// Cells that were regularised, cut, or made within other cells are not those of their seeds: other grains would come of them.
fn check_cells(tess: &Tess, domain: &FileDomain) -> Located<()> {
    let positions: Vec<DVec3> = tess.seeds.iter().map(|seed| seed.position).collect();
    let weights: Vec<f64> = tess.seeds.iter().map(|seed| seed.radius * seed.radius).collect();
    let box_domain = match domain.dimension {
        Dimension::Two => Domain::rectangle(DVec3::ZERO, domain.box_size),
        Dimension::Three => Domain::cuboid(DVec3::ZERO, domain.box_size),
    };
    // A box without sides, and two seeds in one place, are mistakes of any seeds: found when cells are made.
    let Ok(box_domain) = box_domain else { return Ok(()) };
    let cells = Tessellation::power(&box_domain.with_periods(domain.periodic), &positions, &weights);
    let cells = match cells {
        Ok(cells) => cells,
        Err(VoronoiError::OutsideDomain { seed, position, .. }) => {
            let what =
                format!("its seed {position} lies outside the domain; give a file with all seeds inside");
            return Err((SeedPlace::Entry(seed + 1), SeedProblem::Tess { what }));
        }
        Err(_) => return Ok(()),
    };
    let measure = if domain.dimension == Dimension::Two { "area" } else { "volume" };
    let measures = cells.cell_measures();
    for (index, (of_seed, in_file)) in measures.iter().zip(tess.cell_volumes()).enumerate() {
        let error = (of_seed.volume / in_file - 1.0).abs();
        if error.is_nan() || error > VOLUME_TOLERANCE {
            let what = format!(
                "its cell has the {measure} {in_file} and its seed makes one of {}; give a file of one scale whose cells are those of its seeds, not regularized or cut",
                of_seed.volume
            );
            return Err((SeedPlace::Entry(index + 1), SeedProblem::Tess { what }));
        }
    }
    Ok(())
}

fn problem(what: impl Into<String>) -> (SeedPlace, SeedProblem) {
    (SeedPlace::Line(1), SeedProblem::Tess { what: what.into() })
}
