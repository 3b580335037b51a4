//! The tensions of boundaries by the law that is asked for.

use std::fmt;

use polycrystal::{Boundary, BoundaryId, Measures, Network, Side};
use serde::Serialize;

use crate::law_options::LawSource;
use crate::size_file::read_law_file;
use crate::{Config, Error, GrainPhases, GrainTexture, LawError, LawOptions};

/// The least tension of a boundary, as a share of the largest that laws give: a boundary without any would fold.
const FLOOR: f64 = 0.05;

/// The tensions of boundaries by the phases and orientations of their grains.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundaryLaw {
    /// Nothing where all between grains are 1.
    laws: Option<Laws>,
    /// As they were asked for.
    asked: Vec<String>,
    /// In units of the largest tension between grains.
    wall_tension: f64,
    phase_of: Vec<usize>,
    texture: Option<GrainTexture>,
}

/// The law of each pair of phases, as a square table.
#[derive(Debug, Clone, PartialEq)]
struct Laws {
    of_pairs: Vec<Law>,
    phases: usize,
    /// The largest value of all.
    largest: f64,
}

#[derive(Debug, Clone, PartialEq)]
enum Law {
    Number(f64),
    ReadShockley {
        factor: f64,
        angle: f64,
    },
    /// Angles in degrees, in order, and values; between them linear, beyond them constant.
    Table(Vec<[f64; 2]>),
}

/// The tensions of a network.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TensionsReached {
    /// As they were asked for.
    asked: Vec<String>,
    /// Of boundaries between grains; the mean is by number.
    least: f64,
    mean: f64,
    largest: f64,
    /// The least that there may be.
    floor: f64,
    /// Number of boundaries that have it and would have less.
    at_floor: usize,
    /// The grains around each line (in the plane: point) of three boundaries where one tension exceeds the sum of the others.
    without_equilibrium: Vec<Vec<u32>>,
}

impl Law {
    fn new(source: Option<&LawSource>) -> Result<Self, Error> {
        Ok(match source {
            None => Self::Number(1.0),
            Some(LawSource::Number(number)) => Self::Number(*number),
            Some(LawSource::ReadShockley { factor, angle }) => {
                Self::ReadShockley { factor: *factor, angle: *angle }
            }
            Some(LawSource::File(path)) => Self::Table(read_law_file(path)?),
        })
    }

    fn largest(&self) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::ReadShockley { factor, .. } => *factor,
            Self::Table(table) => table.iter().map(|[_, value]| *value).fold(0.0, f64::max),
        }
    }

    /// The value at an angle, which only laws over angles ask for.
    fn at(&self, angle: impl FnOnce() -> Option<f64>) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::ReadShockley { factor, angle: end } => match angle().map_or(1.0, |angle| angle / end) {
                share if share >= 1.0 => *factor,
                share if share > 0.0 => factor * share * (1.0 - libm::log(share)),
                _ => 0.0,
            },
            Self::Table(table) => angle().map_or_else(|| self.largest(), |angle| interpolated(table, angle)),
        }
    }
}

/// The value of a table: between two places linear, beyond them constant.
fn interpolated(table: &[[f64; 2]], place: f64) -> f64 {
    let after = table.partition_point(|[start, _]| *start <= place);
    match (after.checked_sub(1).map(|before| table[before]), table.get(after)) {
        (Some([start, from]), Some([end, to])) => from + (to - from) * (place - start) / (end - start),
        (Some([_, value]), None) | (None, Some(&[_, value])) => value,
        (None, None) => 0.0,
    }
}

impl BoundaryLaw {
    /// The law that a config asks for, of grains of these phases and orientations.
    ///
    /// # Errors
    /// [`Error::Law`]; whatever is wrong with a file.
    pub(crate) fn new(
        config: &Config,
        phases: Option<&GrainPhases>,
        texture: Option<&GrainTexture>,
        grains: usize,
    ) -> Result<Self, Error> {
        let of_pairs = config.laws_of_pairs()?;
        let laws = match config.tensions.is_empty() {
            true => None,
            false => {
                let of_pairs = of_pairs.into_iter().map(Law::new).collect::<Result<Vec<_>, _>>()?;
                let largest = of_pairs.iter().map(Law::largest).fold(0.0, f64::max);
                if largest == 0.0 {
                    return Err(LawError::AllVanish.into());
                }
                Some(Laws { of_pairs, phases: config.phases.len().max(1), largest })
            }
        };
        Ok(Self {
            laws,
            asked: config.tensions.iter().map(LawOptions::text).collect(),
            wall_tension: config.wall_tension,
            phase_of: phases.map_or_else(|| vec![0; grains], |phases| phases.phase_of().to_vec()),
            texture: texture.cloned(),
        })
    }

    /// The tension of a boundary: 1 between grains unless another is asked for, and on walls what is asked for.
    pub(crate) fn tension(&self, boundary: &Boundary) -> f64 {
        if boundary.wall.is_some() {
            return self.wall_tension * self.largest();
        }
        self.asked_tension(boundary).max(FLOOR * self.largest())
    }

    /// The largest tension that may be between grains.
    fn largest(&self) -> f64 {
        self.laws.as_ref().map_or(1.0, |laws| laws.largest)
    }

    /// The tension between grains before what is too small is raised.
    fn asked_tension(&self, boundary: &Boundary) -> f64 {
        let grains = boundary.sides.map(|side| side.grain().map(|grain| grain.index()));
        let (Some(laws), [Some(first), Some(second)]) = (&self.laws, grains) else { return self.largest() };
        let law = &laws.of_pairs[self.phase_of[first] * laws.phases + self.phase_of[second]];
        law.at(|| Some(self.texture.as_ref()?.between(first, second)?.angle))
    }

    /// The tensions of a finished network, where some are asked for.
    pub(crate) fn reached(&self, network: &Network, measures: &Measures) -> Option<TensionsReached> {
        self.laws.as_ref()?;
        let boundaries = network.boundaries();
        // Of those that a period parts one is a copy.
        let is_original =
            |(id, boundary): &(u32, &Boundary)| boundary.twin.is_none_or(|twin| *id < twin.boundary.0);
        let between =
            (0u32..).zip(boundaries).filter(|(_, boundary)| boundary.wall.is_none()).filter(is_original);
        let all: Vec<Boundary> = between
            .map(|(_, boundary)| boundary.between_grains(boundaries))
            .filter(|one| !one.sides.contains(&Side::Exterior))
            .collect();
        let tensions = || all.iter().map(|boundary| self.tension(boundary));
        let floor = FLOOR * self.largest();
        let has_none = |ids: &[BoundaryId]| {
            let mut around: Vec<f64> = ids.iter().map(|id| network.tensions()[id.index()]).collect();
            around.sort_by(f64::total_cmp);
            matches!(around[..], [least, middle, most] if most > least + middle)
        };
        let lines: Vec<(&[Side], &[BoundaryId])> = match measures {
            Measures::Space(space) => {
                space.triple_lines.iter().map(|line| (&line.sides[..], &line.boundaries[..])).collect()
            }
            Measures::Plane(plane) => {
                plane.triple_points.iter().map(|point| (&point.sides[..], &point.boundaries[..])).collect()
            }
        };
        let grains =
            |sides: &[Side]| sides.iter().filter_map(|side| Some(side.grain()?.0)).collect::<Vec<u32>>();
        Some(TensionsReached {
            asked: self.asked.clone(),
            least: tensions().fold(f64::INFINITY, f64::min),
            mean: tensions().sum::<f64>() / all.len().max(1) as f64,
            largest: tensions().fold(0.0, f64::max),
            floor,
            at_floor: all.iter().filter(|boundary| self.asked_tension(boundary) < floor).count(),
            without_equilibrium: lines
                .into_iter()
                .filter(|(sides, ids)| !sides.contains(&Side::Exterior) && has_none(ids))
                .map(|(sides, _)| grains(sides))
                .collect(),
        })
    }
}

/// Lines without equilibrium that a summary names.
const NAMED: usize = 5;

/// The lines of a summary.
impl fmt::Display for TensionsReached {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { asked, least, mean, largest, floor, at_floor, without_equilibrium } = self;
        let asked = asked.join(", ");
        write!(
            out,
            "tensions    asked {asked}; from {least:.4} to {largest:.4} between grains, mean {mean:.4}"
        )?;
        writeln!(out, "; {at_floor} boundaries raised to {floor:.4}, the least that there may be")?;
        if without_equilibrium.is_empty() {
            return Ok(());
        }
        let named = without_equilibrium.iter().take(NAMED).map(|grains| {
            let numbers: Vec<String> = grains.iter().map(u32::to_string).collect();
            numbers.join("-")
        });
        let named: Vec<String> = named.collect();
        let more = match without_equilibrium.len().saturating_sub(NAMED) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        writeln!(
            out,
            "            {} without equilibrium, as one tension exceeds the sum of the others: of grains {}{more}",
            without_equilibrium.len(),
            named.join(", ")
        )
    }
}
