//! Orientations and the boundaries between them.

use std::borrow::Cow;

use polycrystal::{Measures, Side};
use texture::{Orientation, Pair};

use super::origin::Origin;
use super::polycrystal::Polycrystal;
use crate::config::Config;
use crate::error::Error;
use crate::grains::texture::GrainTexture;

impl Polycrystal {
    /// Swaps orientations toward the histogram of disorientations that is asked for, if one is.
    pub(crate) fn fit_misorientations(&mut self) {
        if self.grains().texture.as_ref().is_none_or(|texture| texture.target().is_none()) {
            return;
        }
        let pairs = self.neighbor_pairs();
        if let Origin::Synthetic(synthesis) = &mut self.origin
            && let Some(texture) = &mut synthesis.cells.grains.texture
        {
            texture.swap(&pairs, self.network.cell_volumes(), synthesis.config.random_seed);
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

    /// The orientation of each grain: random where none are known, as maps need some.
    pub(crate) fn orientations(&self) -> Result<Cow<'_, [Orientation]>, Error> {
        match &self.grains().texture {
            Some(texture) => Ok(Cow::Borrowed(texture.orientations())),
            None => {
                let volumes = self.network.cell_volumes();
                let config =
                    self.synthesis().map_or_else(Cow::<Config>::default, |made| Cow::Borrowed(&made.config));
                let textures = config.textures_or_random()?;
                let texture_of = self.grains().phase_of();
                let drawn = GrainTexture::draw(textures, texture_of, volumes, config.random_seed);
                Ok(Cow::Owned(drawn.orientations().to_vec()))
            }
        }
    }
}
