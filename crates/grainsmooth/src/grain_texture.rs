//! The orientations of grains, and what follows from them.

use std::borrow::Cow;
use std::fmt;

use glam::DVec3;
use polycrystal::{Measures, Side};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use serde::Serialize;
use texture::{AngleHistogram, CrystalSymmetry, Disorientation, IpfKey, Orientation, Pair, Texture};

use crate::vtk::ItemTuples;
use crate::{Config, Names, Polycrystal};

/// The generator's stream for orientations, apart from that of the seeds' positions.
const STREAM: u64 = 1;

/// Its stream for swaps of orientations.
const SWAP_STREAM: u64 = 2;

/// Swaps that are tried for each grain: of 1728 grains, 20 bring the sum of all bins' differences below a hundredth (a test).
const TRIES: usize = 20;

/// The orientations of all grains, and the texture that they were drawn from.
#[derive(Debug, Clone, PartialEq)]
pub struct GrainTexture {
    texture: Texture,
    symmetry: CrystalSymmetry,
    orientations: Vec<Orientation>,
    /// Index of the texture's component of each grain.
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
    /// Draws an orientation for each grain, by volume. The seeds' positions do not depend on what is drawn here.
    pub(crate) fn draw(
        texture: Texture,
        symmetry: CrystalSymmetry,
        volumes: &[f64],
        random_seed: u64,
    ) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(random_seed);
        generator.set_stream(STREAM);
        // Rounding may leave nothing of a sliver's.
        let volumes: Vec<f64> = volumes.iter().map(|volume| volume.max(f64::MIN_POSITIVE)).collect();
        let drawn = texture.draw(&volumes, &mut generator).expect("volumes are positive");
        let (orientations, components) = (drawn.orientations, drawn.components);
        Self { texture, symmetry, orientations, components, target: None, fit: None }
    }

    /// The same, with a histogram that the disorientations of neighbours are to have when these are known.
    pub(crate) fn with_target(self, target: Option<AngleHistogram>) -> Self {
        Self { target, ..self }
    }

    /// Swaps orientations toward the histogram that is asked for, if one is and grains have neighbours.
    fn swap(&mut self, pairs: &[Pair], volumes: &[f64], random_seed: u64) {
        let Some(target) = self.target.as_ref().filter(|_| !pairs.is_empty()) else { return };
        let mut generator = ChaCha8Rng::seed_from_u64(random_seed);
        generator.set_stream(SWAP_STREAM);
        let before = target.distance(&self.orientations, self.symmetry, pairs);
        let tries = TRIES * volumes.len();
        let sources = target.swaps(&self.orientations, self.symmetry, pairs, volumes, tries, &mut generator);
        self.orientations = sources.iter().map(|source| self.orientations[*source]).collect();
        self.components = sources.iter().map(|source| self.components[*source]).collect();
        let after = target.distance(&self.orientations, self.symmetry, pairs);
        self.fit = Some(HistogramFit { before, after });
    }

    /// What the disorientations of neighbours are to be, where that is asked for.
    pub(crate) fn target(&self) -> Option<&AngleHistogram> {
        self.target.as_ref()
    }

    /// How near the disorientations of neighbours came to a histogram, where one is asked for.
    pub fn fit(&self) -> Option<HistogramFit> {
        self.fit
    }

    /// The symmetry of the crystals.
    pub fn symmetry(&self) -> CrystalSymmetry {
        self.symmetry
    }

    /// One of each grain.
    pub fn orientations(&self) -> &[Orientation] {
        &self.orientations
    }

    /// The least rotation between the grains on two sides; nothing where one is the exterior.
    pub fn disorientation(&self, sides: [Side; 2]) -> Option<Disorientation> {
        let [Some(first), Some(second)] = sides.map(|side| side.grain().map(|grain| grain.index())) else {
            return None;
        };
        Some(self.symmetry.disorientation(self.orientations[first], self.orientations[second]))
    }

    /// What share of the volume each component was to have, and has.
    pub fn shares(&self, volumes: &[f64]) -> Vec<ComponentShare> {
        let total: f64 = volumes.iter().sum();
        let parts = self.texture.components().enumerate();
        let share = |(number, (_, asked, name)): (usize, (_, f64, &str))| {
            let members = volumes.iter().zip(&self.components).filter(|(_, of)| **of == number);
            let reached = members.map(|(volume, _)| volume).sum::<f64>() / total;
            ComponentShare { name: name.to_owned(), asked, reached }
        };
        parts.map(share).collect()
    }

    /// The texture index: the mean density of the texture at the grains' orientations, by volume. 1 is random. Nothing where a
    /// component has no spread, and so no density.
    pub fn index(&self, volumes: &[f64]) -> Option<f64> {
        let total: f64 = volumes.iter().sum();
        let weighted = self.orientations.iter().zip(volumes);
        let density = |(orientation, volume): (&Orientation, &f64)| {
            volume / total * self.texture.density(*orientation, self.symmetry)
        };
        self.texture.is_spread().then(|| weighted.map(density).sum())
    }

    /// `EulerAngles` of each grain (Bunge, degrees) and `Quaternion` (scalar first, not negative).
    pub(crate) fn orientation_arrays(&self) -> [ItemTuples; 2] {
        let orientations = || self.orientations.iter();
        [
            ItemTuples::numbers("EulerAngles", orientations().map(|one| one.euler_degrees())),
            ItemTuples::numbers("Quaternion", orientations().map(|one| one.quaternion())),
        ]
    }

    /// The inverse pole figure colours of each grain for the sample's axes.
    pub(crate) fn color_arrays(&self, names: Names) -> [ItemTuples; 3] {
        let key = IpfKey::new(self.symmetry);
        let [x, y, z] = names.inverse_pole_figures();
        [(x, DVec3::X), (y, DVec3::Y), (z, DVec3::Z)].map(|(name, axis)| {
            ItemTuples::bytes(name, self.orientations.iter().map(|one| key.color_of(*one, axis)))
        })
    }

    /// What files hold of each boundary, given by its sides: the angle of its `Disorientation` in degrees, and the axis.
    pub(crate) fn boundary_arrays(&self, sides: impl Iterator<Item = [Side; 2]>) -> Vec<ItemTuples> {
        let found: Vec<Option<Disorientation>> = sides.map(|sides| self.disorientation(sides)).collect();
        let angle = |found: &Option<Disorientation>| [found.map_or(f64::NAN, |found| found.angle)];
        let axis = |found: &Option<Disorientation>| found.map_or(DVec3::NAN, |found| found.axis).to_array();
        vec![
            ItemTuples::numbers("Disorientation", found.iter().map(angle)),
            ItemTuples::numbers("DisorientationAxis", found.iter().map(axis)),
        ]
    }
}

impl Polycrystal {
    /// Swaps orientations toward the histogram of disorientations that is asked for, if one is.
    pub(crate) fn fit_misorientations(&mut self) {
        if self.cells.texture.as_ref().is_none_or(|texture| texture.target.is_none()) {
            return;
        }
        let pairs = self.neighbor_pairs();
        if let Some(texture) = &mut self.cells.texture {
            texture.swap(&pairs, self.network.cell_volumes(), self.config.random_seed);
        }
    }

    /// The grains on both sides of each boundary between two, and its area; in the plane its length.
    pub(crate) fn neighbor_pairs(&self) -> Vec<Pair> {
        let pair = |sides: [Side; 2], area: f64| {
            let [first, second] = sides.map(|side| side.grain().map(|grain| grain.index()));
            // A grain may meet its own image.
            first
                .zip(second)
                .filter(|(first, second)| first != second)
                .map(|(first, second)| (first, second, area))
        };
        match self.measures() {
            Measures::Space(all) => {
                all.boundaries.iter().filter_map(|one| pair(one.sides, one.area)).collect()
            }
            Measures::Plane(all) => {
                all.boundaries.iter().filter_map(|one| pair(one.sides, one.length)).collect()
            }
        }
    }

    /// The orientation of each grain: random by the config's seed where no texture is asked for, as maps need some.
    pub(crate) fn orientations(&self) -> Cow<'_, [Orientation]> {
        match &self.cells.texture {
            Some(texture) => Cow::Borrowed(&texture.orientations),
            None => {
                let Config { random_seed, texture, .. } = &self.config;
                let volumes = self.network.cell_volumes();
                let drawn = GrainTexture::draw(Texture::random(), texture.symmetry, volumes, *random_seed);
                Cow::Owned(drawn.orientations)
            }
        }
    }
}

/// The line of a summary, for grains of some volumes.
pub(crate) struct TextureLine<'a>(pub(crate) &'a GrainTexture, pub(crate) &'a [f64]);

impl fmt::Display for TextureLine<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(texture, volumes) = self;
        let share = |share: &ComponentShare| {
            let ComponentShare { name, asked, reached } = share;
            format!("{name} {:.1} % of the volume (asked {:.1} %)", 100.0 * reached, 100.0 * asked)
        };
        let shares: Vec<String> = texture.shares(volumes).iter().map(share).collect();
        write!(out, "{} crystals, {}", texture.symmetry, shares.join(", "))?;
        if let Some(index) = texture.index(volumes) {
            write!(out, "; texture index {index:.2}")?;
        }
        match texture.fit {
            Some(HistogramFit { before, after }) => write!(
                out,
                "; disorientations of neighbours are {after:.4} from those asked for, {before:.4} before swaps (sum of all bins' differences)"
            ),
            None => Ok(()),
        }
    }
}
