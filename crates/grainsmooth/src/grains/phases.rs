//! The phase of each grain.

use std::fmt;

use serde::Serialize;
use texture::CrystalSymmetry;
use voronoi::Tessellation;
use voronoi::volumes::InclusionPlace;

use crate::grains::placed::contact_areas;
use crate::names::PHASE;
use crate::vtk::ItemTuples;
use crate::{Config, GrainCells, GrainSizes, PhasePlace};

/// The phases, and which of them each grain is of.
#[derive(Debug, Clone, PartialEq)]
pub struct GrainPhases {
    phases: Vec<Phase>,
    /// Index of each grain's phase.
    phase_of: Vec<usize>,
    /// What is told of the neighbours of each phase's grains, in the cells.
    neighbors: Vec<PhaseNeighbors>,
}

/// What the grains of a phase have beside them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct PhaseNeighbors {
    contiguity: Option<f64>,
    /// Of grains that are to touch so many others, how many do.
    in_place: Option<usize>,
}

/// What all grains of a phase share.
#[derive(Debug, Clone, PartialEq)]
struct Phase {
    name: String,
    /// The share of the volume that was asked for, where it was.
    fraction: Option<f64>,
    symmetry: CrystalSymmetry,
    /// By which diameters that all phases share are multiplied beside their common factor, so that the phase has its volume.
    scale: f64,
    place: Option<PhasePlace>,
}

/// What of the volume a phase has.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PhaseShare {
    /// Its name.
    pub name: String,
    /// Its number in files, from 1.
    pub number: u32,
    /// Number of its grains.
    pub grains: usize,
    /// The symmetry of its crystals, as a group of rotations.
    pub crystal_symmetry: &'static str,
    /// The share of the volume that was asked for (in the plane: of the area), where it was.
    pub fraction_asked: Option<f64>,
    /// The share that its cells have.
    pub fraction_of_cells: f64,
    /// The share that its finished grains have.
    pub fraction: f64,
    /// By which diameters that all phases share are multiplied beside their common factor.
    pub scale: f64,
    /// Where its grains were to be.
    pub place: Option<PhasePlace>,
    /// Number of grains that touch as many others in the cells as meet at their place.
    pub in_place: Option<usize>,
    /// The share of its grains' surface in the cells, walls left out, that they have with each other, each such boundary counted for both grains; none without such surface.
    pub contiguity: Option<f64>,
}

/// The least share of a grain's surface that another must have to count as one that it touches.
const LEAST_CONTACT: f64 = 0.02;

impl GrainPhases {
    /// The phases that a config asks for, as sizes were given to them; nothing without phases.
    pub(crate) fn new(config: &Config, sizes: &GrainSizes) -> Option<Self> {
        let phase = |((options, fraction), scale): ((&crate::PhaseOptions, f64), &f64)| Phase {
            name: options.name.clone(),
            fraction: Some(fraction),
            symmetry: options.symmetry.unwrap_or(config.texture.symmetry),
            scale: *scale,
            place: options.place,
        };
        let asked = config.phases.iter().zip(config.phase_fractions());
        let phases: Vec<Phase> = asked.zip(sizes.phase_scales()).map(phase).collect();
        let neighbors = vec![PhaseNeighbors::default(); phases.len()];
        (!phases.is_empty()).then(|| Self { phases, phase_of: sizes.phase_of().to_vec(), neighbors })
    }

    /// Measured phases by name and symmetry, and the index of each grain's phase.
    pub(crate) fn measured(phases: Vec<(String, CrystalSymmetry)>, phase_of: Vec<usize>) -> Self {
        let phase = |(name, symmetry)| Phase { name, fraction: None, symmetry, scale: 1.0, place: None };
        let neighbors = vec![PhaseNeighbors::default(); phases.len()];
        Self { phases: phases.into_iter().map(phase).collect(), phase_of, neighbors }
    }

    /// The same with what is beside the grains.
    pub(crate) fn among(mut self, cells: &Tessellation, grains: Option<&GrainCells>) -> Self {
        let contacts = contact_areas(cells, grains, self.phase_of.len());
        for (number, phase) in self.phases.iter().enumerate() {
            let own =
                || contacts.iter().zip(&self.phase_of).filter(|(_, of)| **of == number).map(|(own, _)| own);
            let is_alike = |(other, _): &&(usize, f64)| self.phase_of[*other] == number;
            let area: f64 = own().flatten().map(|(_, area)| area).sum();
            let alike: f64 = own().flatten().filter(is_alike).map(|(_, area)| area).sum();
            let touched = |own: &&Vec<(usize, f64)>| {
                let least = LEAST_CONTACT * own.iter().map(|(_, area)| area).sum::<f64>();
                own.iter().filter(|(_, area)| *area > least).count()
            };
            let place = phase.place.and_then(PhasePlace::of_inclusions);
            self.neighbors[number] = PhaseNeighbors {
                contiguity: (area > 0.0).then(|| alike / area),
                in_place: place.map(|place| own().filter(|own| touched(own) == place.cells()).count()),
            };
        }
        self
    }

    /// The same for parts of the grains, given the grain that each is of.
    pub(crate) fn of_parts(self, parent_of: &[usize]) -> Self {
        let phase_of = parent_of.iter().map(|parent| self.phase_of[*parent]).collect();
        Self { phase_of, ..self }
    }

    /// Index of each grain's phase.
    pub fn phase_of(&self) -> &[usize] {
        &self.phase_of
    }

    /// The phases' names.
    pub fn names(&self) -> impl ExactSizeIterator<Item = &str> {
        self.phases.iter().map(|phase| phase.name.as_str())
    }

    /// The symmetry of each phase's crystals.
    pub(crate) fn symmetries(&self) -> impl ExactSizeIterator<Item = CrystalSymmetry> {
        self.phases.iter().map(|phase| phase.symmetry)
    }

    /// The number in files of a grain's phase: from 1, as in orientation maps, where 0 is none.
    pub(crate) fn number(&self, grain: usize) -> i32 {
        // Phases stand on the command line, which holds far fewer.
        1 + i32::try_from(self.phase_of[grain]).expect("fewer phases than 2^31")
    }

    /// What files hold of each grain's phase.
    pub(crate) fn array(&self) -> ItemTuples {
        ItemTuples::new(PHASE, (0..self.phase_of.len()).map(|grain| [self.number(grain)]))
    }

    /// What of the volume each phase has, in the cells and in the finished grains.
    pub fn shares(&self, cells: &[f64], grains: &[f64]) -> Vec<PhaseShare> {
        let share = |volumes: &[f64], phase: usize| {
            let own = volumes.iter().zip(&self.phase_of).filter(|(_, of)| **of == phase);
            own.map(|(volume, _)| volume).sum::<f64>() / volumes.iter().sum::<f64>()
        };
        let phases = (0..).zip(1..).zip(&self.phases);
        let found = |((index, number), phase): ((usize, u32), &Phase)| PhaseShare {
            name: phase.name.clone(),
            number,
            grains: self.phase_of.iter().filter(|of| **of == index).count(),
            crystal_symmetry: phase.symmetry.rotation_group(),
            fraction_asked: phase.fraction,
            fraction_of_cells: share(cells, index),
            fraction: share(grains, index),
            scale: phase.scale,
            place: phase.place,
            in_place: self.neighbors[index].in_place,
            contiguity: self.neighbors[index].contiguity,
        };
        phases.map(found).collect()
    }
}

impl fmt::Display for PhaseShare {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, grains, crystal_symmetry, fraction, fraction_asked, scale, place, .. } = self;
        write!(out, "{name} {:.6} % of the material", 100.0 * fraction)?;
        if let Some(asked) = fraction_asked {
            write!(out, " (asked {:.6} %)", 100.0 * asked)?;
        }
        write!(out, " in {grains} grains, {crystal_symmetry}")?;
        if (scale - 1.0).abs() > 5e-7 {
            write!(out, ", diameters times {scale:.6}")?;
        }
        match (place, self.in_place, self.contiguity) {
            (Some(place), Some(count), _) => {
                let cells = place.of_inclusions().map_or(0, InclusionPlace::cells);
                write!(out, ", {place} ({count} touch {cells} grain{})", if cells == 1 { "" } else { "s" })
            }
            (Some(place), None, Some(contiguity)) => write!(out, ", {place} (contiguity {contiguity:.2})"),
            _ => Ok(()),
        }
    }
}
