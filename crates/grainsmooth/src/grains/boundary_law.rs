//! The tensions and mobilities of boundaries by the laws that are asked for.

use std::fmt;

use glam::DVec3;
use polycrystal::{Boundary, BoundaryId, Measures, Network, NetworkError, Side, measure_network};
use serde::Serialize;

use crate::error::failure::line_name;
use crate::input::size_file::read_law_file;
use crate::{
    Config, Error, GrainPhases, GrainTexture, LawCurve, LawError, LawKind, LawOptions, LawProblem, LawSource,
};

/// The least tension or mobility of a boundary, as a share of the largest that laws give: a boundary without tension would fold, one
/// without mobility never move.
const FLOOR: f64 = 0.05;

/// The tensions and mobilities of boundaries by the phases and orientations of their grains.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundaryLaw {
    /// Nothing where all between grains are 1.
    tensions: Option<Laws>,
    /// The same.
    mobilities: Option<Laws>,
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
    /// As they were asked for.
    asked: Vec<String>,
}

#[derive(Debug, Clone, PartialEq)]
enum Law {
    Number(f64),
    Curve {
        factor: f64,
        curve: LawCurve,
        angle: f64,
    },
    /// Angles in degrees, in order, and values; between them linear, beyond them constant.
    Table(Vec<[f64; 2]>),
}

/// The tensions or mobilities of a network's boundaries between grains.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LawReached {
    /// As they were asked for.
    asked: Vec<String>,
    least: f64,
    /// By number.
    mean: f64,
    largest: f64,
    /// The least that there may be.
    floor: f64,
    /// Number of boundaries that have it and would have less.
    at_floor: usize,
}

/// The tensions of a network.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TensionsReached {
    #[serde(flatten)]
    law: LawReached,
    /// The grains around each line (in the plane: point) of three boundaries where one tension exceeds the sum of the others.
    pub(crate) without_equilibrium: Vec<Vec<u32>>,
}

impl Laws {
    /// The laws of a kind that a config asks for, if it does.
    fn new(config: &Config, kind: LawKind) -> Result<Option<Self>, Error> {
        let asked = config.laws(kind);
        if asked.is_empty() {
            return Ok(None);
        }
        let of_pairs = config.laws_of_pairs(kind)?.into_iter();
        let of_pairs = of_pairs.map(|source| Law::new(source, kind)).collect::<Result<Vec<_>, _>>()?;
        let largest = of_pairs.iter().map(Law::largest).fold(0.0, f64::max);
        if largest == 0.0 {
            return Err(LawError { kind, problem: LawProblem::AllVanish }.into());
        }
        let asked = asked.iter().map(LawOptions::to_string).collect();
        Ok(Some(Self { of_pairs, phases: config.phases.len().max(1), largest, asked }))
    }

    fn floor(&self) -> f64 {
        FLOOR * self.largest
    }
}

impl Law {
    fn new(source: Option<&LawSource>, kind: LawKind) -> Result<Self, Error> {
        Ok(match source {
            None => Self::Number(1.0),
            Some(LawSource::Number(number)) => Self::Number(*number),
            Some(&LawSource::Curve { factor, curve, angle }) => Self::Curve { factor, curve, angle },
            Some(LawSource::File(path)) => Self::Table(read_law_file(path, kind)?),
        })
    }

    fn largest(&self) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::Curve { factor, .. } => *factor,
            Self::Table(table) => table.iter().map(|[_, value]| *value).fold(0.0, f64::max),
        }
    }

    /// The value at an angle, which only laws over angles ask for.
    fn at(&self, angle: impl FnOnce() -> Option<f64>) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::Curve { factor, curve, angle: end } => {
                factor * angle().map_or(1.0, |angle| curve.at(angle / end))
            }
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
        Ok(Self {
            tensions: Laws::new(config, LawKind::Tension)?,
            mobilities: Laws::new(config, LawKind::Mobility)?,
            wall_tension: config.wall_tension,
            phase_of: phases.map_or_else(|| vec![0; grains], |phases| phases.phase_of().to_vec()),
            texture: texture.cloned(),
        })
    }

    /// A network whose boundaries have what is asked for.
    ///
    /// # Errors
    /// As of [`Network::with_tensions`] and [`Network::with_mobilities`].
    pub(crate) fn apply(&self, network: Network) -> Result<Network, NetworkError> {
        let network = network.with_tensions(|boundary| self.tension(boundary))?;
        match self.mobilities {
            Some(_) => network.with_mobilities(|boundary| self.mobility(boundary)),
            None => Ok(network),
        }
    }

    /// The mobility of a boundary: 1 unless another is asked for.
    pub(crate) fn mobility(&self, boundary: &Boundary) -> f64 {
        self.mobilities.as_ref().map_or(1.0, |laws| self.value(laws, boundary).max(laws.floor()))
    }

    /// The tension of a boundary: 1 between grains unless another is asked for, and on walls what is asked for.
    pub(crate) fn tension(&self, boundary: &Boundary) -> f64 {
        let largest = self.tensions.as_ref().map_or(1.0, |laws| laws.largest);
        match &self.tensions {
            _ if boundary.wall.is_some() => self.wall_tension * largest,
            Some(laws) => self.value(laws, boundary).max(laws.floor()),
            None => 1.0,
        }
    }

    /// What laws give a boundary before what is too small is raised.
    fn value(&self, laws: &Laws, boundary: &Boundary) -> f64 {
        let grains = boundary.sides.map(|side| side.grain().map(|grain| grain.index()));
        let [Some(first), Some(second)] = grains else { return laws.largest };
        let law = &laws.of_pairs[self.phase_of[first] * laws.phases + self.phase_of[second]];
        law.at(|| Some(self.texture.as_ref()?.between(first, second)?.angle))
    }

    /// The tensions of a finished network, where some are asked for.
    pub(crate) fn tensions_reached(
        &self,
        network: &Network,
        measures: impl FnOnce() -> Measures,
    ) -> Option<TensionsReached> {
        let laws = self.tensions.as_ref()?;
        Some(TensionsReached {
            law: self.reached(laws, network),
            without_equilibrium: without_equilibrium(network, &measures()),
        })
    }

    /// The mobilities of a network, where some are asked for.
    pub(crate) fn mobilities_reached(&self, network: &Network) -> Option<LawReached> {
        Some(self.reached(self.mobilities.as_ref()?, network))
    }

    fn reached(&self, laws: &Laws, network: &Network) -> LawReached {
        let boundaries = network.boundaries();
        // Of those that a period parts one is a copy.
        let is_original =
            |(id, boundary): &(u32, &Boundary)| boundary.twin.is_none_or(|twin| *id < twin.boundary.0);
        let between =
            (0u32..).zip(boundaries).filter(|(_, boundary)| boundary.wall.is_none()).filter(is_original);
        let between = between.map(|(_, boundary)| boundary.between_grains(boundaries));
        let asked: Vec<f64> = between
            .filter(|one| !one.sides.contains(&Side::Exterior))
            .map(|boundary| self.value(laws, &boundary))
            .collect();
        let floor = laws.floor();
        let values = || asked.iter().map(|value| value.max(floor));
        LawReached {
            asked: laws.asked.clone(),
            least: values().fold(f64::INFINITY, f64::min),
            mean: values().sum::<f64>() / asked.len().max(1) as f64,
            largest: values().fold(0.0, f64::max),
            floor,
            at_floor: asked.iter().filter(|value| **value < floor).count(),
        }
    }

    /// The grains around each line (in the plane: point) of some cells where one tension exceeds the sum of the others; `network` makes that of
    /// the cells.
    pub(crate) fn without_equilibrium_in(
        &self,
        network: impl FnOnce() -> Result<(Network, Vec<DVec3>), NetworkError>,
    ) -> Vec<Vec<u32>> {
        if self.tensions.is_none() {
            return Vec::new();
        }
        // Cells of which no network can be made have another fault to name.
        let Ok((network, points)) = network() else { return Vec::new() };
        let Ok(network) = self.apply(network) else { return Vec::new() };
        without_equilibrium(&network, &measure_network(&network, &points))
    }
}

fn without_equilibrium(network: &Network, measures: &Measures) -> Vec<Vec<u32>> {
    let has_none = |ids: &[BoundaryId]| {
        let mut around: Vec<f64> = ids.iter().map(|id| network.tensions()[id.index()]).collect();
        around.sort_unstable_by(f64::total_cmp);
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
    let grains = |sides: &[Side]| sides.iter().filter_map(|side| Some(side.grain()?.0)).collect();
    lines
        .into_iter()
        .filter(|(sides, ids)| !sides.contains(&Side::Exterior) && has_none(ids))
        .map(|(sides, _)| grains(sides))
        .collect()
}

/// Lines without equilibrium that a summary names.
const NAMED: usize = 5;

impl fmt::Display for LawReached {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { asked, least, mean, largest, floor, at_floor } = self;
        let asked = asked.join(", ");
        write!(out, "asked {asked}; from {least:.4} to {largest:.4} between grains, mean {mean:.4}")?;
        write!(out, "; {at_floor} boundaries raised to {floor:.4}, the least that there may be")
    }
}

/// The lines of a summary.
impl fmt::Display for TensionsReached {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { law, without_equilibrium } = self;
        writeln!(out, "tensions    {law}")?;
        if without_equilibrium.is_empty() {
            return Ok(());
        }
        let named: Vec<String> =
            without_equilibrium.iter().take(NAMED).map(|grains| line_name(grains)).collect();
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
