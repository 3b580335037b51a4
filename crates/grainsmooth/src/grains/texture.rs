//! The orientations of grains, and what follows from them.

use std::fmt;

use glam::DVec3;
use polycrystal::Side;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use serde::Serialize;
use texture::{AngleHistogram, CrystalSymmetry, Disorientation, IpfKey, Orientation, Pair, Texture};

use super::wanted_textures::PhaseTexture;
use crate::names::Names;
use crate::vtk::ItemTuples;

/// The generator's stream for orientations, apart from that of the seeds' positions.
const STREAM: u64 = 1;

/// Its stream for swaps of orientations.
const SWAP_STREAM: u64 = 2;

/// Swaps that are tried for each grain: of 1728 grains, 20 bring the sum of all bins' differences below a hundredth (a test).
const TRIES: usize = 20;

/// The orientations of all grains, and the textures that they were drawn from where they were not measured.
#[derive(Debug, Clone, PartialEq)]
pub struct GrainTexture {
    /// The symmetry of each phase's crystals; one of all grains without phases.
    symmetries: Vec<CrystalSymmetry>,
    /// Index of each grain's phase.
    phase_of: Vec<usize>,
    orientations: Vec<Orientation>,
    /// What they were drawn from; nothing where they were measured.
    drawn: Option<DrawnFrom>,
}

/// What orientations were drawn from.
#[derive(Debug, Clone, PartialEq)]
struct DrawnFrom {
    /// One of each phase; one of all grains without phases.
    textures: Vec<Texture>,
    /// Index of each grain's component of its texture.
    components: Vec<usize>,
    /// What the disorientations of neighbours are to be, where that is asked for.
    target: Option<AngleHistogram>,
    /// How far they were from it, and are after swaps.
    fit: Option<HistogramFit>,
}

/// How far the disorientations of neighbours are from a histogram: the sum of the differences of all bins, from 0 to 2.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HistogramFit {
    /// As orientations were drawn.
    pub before: f64,
    /// After swaps.
    pub after: f64,
}

/// A component of a texture, and what of the volume it has.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComponentShare {
    /// As it was asked for.
    pub name: String,
    /// The share that was asked for.
    pub asked: f64,
    /// The share of the grains' volumes.
    pub reached: f64,
}

impl GrainTexture {
    /// Draws an orientation for each grain from its texture, by volume. The seeds' positions do not depend on what is drawn here.
    pub(crate) fn draw(
        textures: Vec<PhaseTexture>,
        phase_of: Vec<usize>,
        volumes: &[f64],
        random_seed: u64,
    ) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(random_seed);
        generator.set_stream(STREAM);
        let mut orientations = vec![Orientation::IDENTITY; volumes.len()];
        let mut components = vec![0; volumes.len()];
        for (number, of_phase) in textures.iter().enumerate() {
            let members: Vec<usize> = (0..volumes.len()).filter(|grain| phase_of[*grain] == number).collect();
            // Rounding may leave nothing of a sliver's.
            let volumes: Vec<f64> =
                members.iter().map(|grain| volumes[*grain].max(f64::MIN_POSITIVE)).collect();
            let drawn = of_phase.texture.draw(&volumes, &mut generator).expect("volumes are positive");
            for ((grain, orientation), component) in
                members.iter().zip(drawn.orientations).zip(drawn.components)
            {
                (orientations[*grain], components[*grain]) = (orientation, component);
            }
        }
        let symmetries = textures.iter().map(|of_phase| of_phase.symmetry).collect();
        let textures = textures.into_iter().map(|of_phase| of_phase.texture).collect();
        let drawn = Some(DrawnFrom { textures, components, target: None, fit: None });
        Self { symmetries, phase_of, orientations, drawn }
    }

    /// Measured orientations of grains, with the phase of each and the symmetry of each phase.
    pub(crate) fn measured(
        symmetries: Vec<CrystalSymmetry>,
        phase_of: Vec<usize>,
        orientations: Vec<Orientation>,
    ) -> Self {
        Self { symmetries, phase_of, orientations, drawn: None }
    }

    /// The same, with a histogram that the disorientations of neighbours are to have when these are known.
    pub(crate) fn with_target(mut self, target: Option<AngleHistogram>) -> Self {
        if let Some(drawn) = &mut self.drawn {
            drawn.target = target;
        }
        self
    }

    /// Swaps orientations toward the histogram that is asked for, if one is and grains have neighbours.
    pub(crate) fn swap(&mut self, pairs: &[Pair], volumes: &[f64], random_seed: u64) {
        let Some(drawn) = &mut self.drawn else { return };
        let Some(target) = drawn.target.as_ref().filter(|_| !pairs.is_empty()) else { return };
        let mut generator = ChaCha8Rng::seed_from_u64(random_seed);
        generator.set_stream(SWAP_STREAM);
        // Phases are refused beside a histogram.
        let symmetry = self.symmetries[0];
        let before = target.distance(&self.orientations, symmetry, pairs);
        let tries = TRIES * volumes.len();
        let sources = target.swaps(&self.orientations, symmetry, pairs, volumes, tries, &mut generator);
        self.orientations = sources.iter().map(|source| self.orientations[*source]).collect();
        drawn.components = sources.iter().map(|source| drawn.components[*source]).collect();
        let after = target.distance(&self.orientations, symmetry, pairs);
        drawn.fit = Some(HistogramFit { before, after });
    }

    /// What the disorientations of neighbours are to be, where that is asked for.
    pub(crate) fn target(&self) -> Option<&AngleHistogram> {
        self.drawn.as_ref()?.target.as_ref()
    }

    /// How near the disorientations of neighbours came to a histogram, where one is asked for.
    pub fn fit(&self) -> Option<HistogramFit> {
        self.drawn.as_ref()?.fit
    }

    /// The symmetry of a grain's crystal.
    pub fn symmetry_of(&self, grain: usize) -> CrystalSymmetry {
        self.symmetries[self.phase_of[grain]]
    }

    /// The symmetry of all crystals; nothing where phases have different ones.
    pub fn symmetry(&self) -> Option<CrystalSymmetry> {
        let first = self.symmetries[0];
        self.symmetries.iter().all(|symmetry| *symmetry == first).then_some(first)
    }

    /// The symmetries of the crystals, each once.
    pub fn symmetries(&self) -> Vec<CrystalSymmetry> {
        let mut symmetries = Vec::new();
        for symmetry in &self.symmetries {
            if !symmetries.contains(symmetry) {
                symmetries.push(*symmetry);
            }
        }
        symmetries
    }

    /// Number of textures: one of each phase, or one of all grains.
    pub fn texture_count(&self) -> usize {
        self.symmetries.len()
    }

    /// The symmetry of a texture's crystals, and the numbers of the grains that have it.
    pub(crate) fn members(&self, texture: usize) -> (CrystalSymmetry, Vec<usize>) {
        let members = (0..self.phase_of.len()).filter(|grain| self.phase_of[*grain] == texture);
        (self.symmetries[texture], members.collect())
    }

    /// One of each grain.
    pub fn orientations(&self) -> &[Orientation] {
        &self.orientations
    }

    /// The least rotation between two grains; nothing where their crystals have different symmetries: which axes of two lattices go
    /// together is no matter of symmetry then.
    pub(crate) fn between(&self, first: usize, second: usize) -> Option<Disorientation> {
        let symmetry = self.symmetry_of(first);
        let is_one = symmetry == self.symmetry_of(second);
        is_one.then(|| symmetry.disorientation(self.orientations[first], self.orientations[second]))
    }

    /// The same of the grains on two sides; nothing where one is the exterior.
    pub fn disorientation(&self, sides: [Side; 2]) -> Option<Disorientation> {
        let [Some(first), Some(second)] = sides.map(|side| side.grain().map(|grain| grain.index())) else {
            return None;
        };
        self.between(first, second)
    }

    /// What share of a texture's volume each of its components was to have, and has; nothing of measured orientations.
    pub fn shares(&self, texture: usize, volumes: &[f64]) -> Vec<ComponentShare> {
        let Some(drawn) = &self.drawn else { return Vec::new() };
        let (_, members) = self.members(texture);
        let volume =
            |members: &mut dyn Iterator<Item = &usize>| members.map(|grain| volumes[*grain]).sum::<f64>();
        let total = volume(&mut members.iter());
        let parts = drawn.textures[texture].components().enumerate();
        let share = |(number, (_, asked, name)): (usize, (_, f64, &str))| {
            let own = volume(&mut members.iter().filter(|grain| drawn.components[**grain] == number));
            ComponentShare { name: name.to_owned(), asked, reached: own / total }
        };
        parts.map(share).collect()
    }

    /// A texture's index: its mean density at its grains' orientations, by volume. 1 is random. Nothing where a
    /// component has no spread, and so no density, and of measured orientations.
    pub fn index(&self, texture: usize, volumes: &[f64]) -> Option<f64> {
        let (symmetry, members) = self.members(texture);
        let texture = &self.drawn.as_ref()?.textures[texture];
        let total: f64 = members.iter().map(|grain| volumes[*grain]).sum();
        let density =
            |grain: &usize| volumes[*grain] / total * texture.density(self.orientations[*grain], symmetry);
        texture.is_spread().then(|| members.iter().map(density).sum())
    }

    /// `EulerAngles` of each grain (Bunge, degrees) and `Quaternion` (scalar first, not negative).
    pub(crate) fn orientation_arrays(&self) -> [ItemTuples; 2] {
        let orientations = || self.orientations.iter();
        [
            ItemTuples::new("EulerAngles", orientations().map(|one| one.euler_degrees())),
            ItemTuples::new("Quaternion", orientations().map(|one| one.quaternion())),
        ]
    }

    /// The inverse pole figure colours of each grain for the sample's axes.
    pub(crate) fn color_arrays(&self, names: Names) -> [ItemTuples; 3] {
        let [x, y, z] = names.inverse_pole_figures();
        [(x, DVec3::X), (y, DVec3::Y), (z, DVec3::Z)]
            .map(|(name, axis)| ItemTuples::new(name, self.colors(axis)))
    }

    /// The inverse pole figure colour of each grain for an axis of the sample.
    pub(crate) fn colors(&self, axis: DVec3) -> impl Iterator<Item = [u8; 3]> {
        let keys: Vec<IpfKey> = self.symmetries.iter().map(|symmetry| IpfKey::new(*symmetry)).collect();
        let grains = self.orientations.iter().zip(&self.phase_of);
        grains.map(move |(one, phase)| keys[*phase].color_of(*one, axis))
    }

    /// What files hold of each boundary, given by its sides: the angle of its `Disorientation` in degrees, and the axis.
    pub(crate) fn boundary_arrays(&self, sides: impl Iterator<Item = [Side; 2]>) -> Vec<ItemTuples> {
        let found: Vec<Option<Disorientation>> = sides.map(|sides| self.disorientation(sides)).collect();
        let angle = |found: &Option<Disorientation>| [found.map_or(f64::NAN, |found| found.angle)];
        let axis = |found: &Option<Disorientation>| found.map_or(DVec3::NAN, |found| found.axis).to_array();
        vec![
            ItemTuples::new("Disorientation", found.iter().map(angle)),
            ItemTuples::new("DisorientationAxis", found.iter().map(axis)),
        ]
    }
}

/// A texture in words, for grains of some volumes.
pub(crate) struct TextureLine<'a> {
    pub(crate) texture: &'a GrainTexture,
    /// Which of its textures.
    pub(crate) number: usize,
    pub(crate) volumes: &'a [f64],
}

impl fmt::Display for TextureLine<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { texture, number, volumes } = self;
        let share = |share: &ComponentShare| {
            let ComponentShare { name, asked, reached } = share;
            format!("{name} {:.1} % of the volume (asked {:.1} %)", 100.0 * reached, 100.0 * asked)
        };
        let shares: Vec<String> = texture.shares(*number, volumes).iter().map(share).collect();
        write!(out, "{} crystals, {}", texture.symmetries[*number], shares.join(", "))?;
        if let Some(index) = texture.index(*number, volumes) {
            write!(out, "; texture index {index:.2}")?;
        }
        match texture.fit() {
            Some(HistogramFit { before, after }) => write!(
                out,
                "; disorientations of neighbours are {after:.4} from those asked for, {before:.4} before swaps (sum of all bins' differences)"
            ),
            None => Ok(()),
        }
    }
}
