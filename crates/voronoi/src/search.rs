//! The search for the sites around a cell, with as many periodic images as the cell needs.

use glam::DVec3;

use crate::Domain;
use crate::images::ImageTable;
use crate::near_seeds::{Cutting, NearSeeds};
use crate::predicate::ExactInput;

/// Thickness of the first layer of images in units of the mean distance of seeds. Cells of random seeds look no farther
/// than that: a sphere of half the radius without a seed in it has a chance of 1e-14.
const FIRST_THICKNESS: f64 = 4.0;

/// How much thicker each further layer is than the one before.
const GROWTH: f64 = 3.0;

/// Seeds and the images around them. Each layer's images begin with those of the one before, so sites keep their numbers.
pub(crate) struct Search<'a> {
    domain: &'a Domain,
    seeds: &'a [DVec3],
    weights: Option<&'a [f64]>,
    layers: Vec<Layer>,
}

struct Layer {
    /// Along each axis, how far beyond the domain all images are known; infinite where there are no more to know.
    thickness: DVec3,
    images: ImageTable,
    near_seeds: NearSeeds,
}

impl<'a> Search<'a> {
    pub(crate) fn new(domain: &'a Domain, seeds: &'a [DVec3], weights: Option<&'a [f64]>) -> Self {
        let mut search = Self { domain, seeds, weights, layers: Vec::new() };
        search.widen();
        search
    }

    pub(crate) fn seed_count(&self) -> usize {
        self.seeds.len()
    }

    /// The seeds and all images that were looked at.
    pub(crate) fn input(&self) -> ExactInput<'_> {
        self.layer_input(&self.layers[self.layers.len() - 1])
    }

    fn layer_input<'b>(&'b self, layer: &'b Layer) -> ExactInput<'b> {
        ExactInput { domain: self.domain, seeds: self.seeds, weights: self.weights, images: &layer.images }
    }

    /// Adds a layer of images, until there are enough for every cell.
    pub(crate) fn widen(&mut self) {
        let size = self.domain.size();
        let spacing = (self.domain.measure() / self.seeds.len() as f64).powf(1.0 / self.domain.axes() as f64);
        let exponent = i32::try_from(self.layers.len()).unwrap_or(i32::MAX);
        let wanted = FIRST_THICKNESS * spacing * GROWTH.powi(exponent);
        let thickness = DVec3::from_array([0, 1, 2].map(|axis| {
            // Below half a period, so that a cell which does not yet know its own image cannot pass as finished.
            let is_partial = self.domain.periodic().test(axis) && wanted < 0.45 * size[axis];
            if is_partial { wanted } else { f64::INFINITY }
        }));
        let none = ImageTable::default();
        let before = self.layers.last().map_or(&none, |layer| &layer.images);
        let images = if self.domain.is_periodic() {
            before.widened(self.domain, self.seeds, thickness.min(size))
        } else {
            none
        };
        let input =
            ExactInput { domain: self.domain, seeds: self.seeds, weights: self.weights, images: &images };
        let near_seeds = NearSeeds::new(input);
        self.layers.push(Layer { thickness, images, near_seeds });
    }

    /// Cuts the cell of a seed and returns the input of its generators; nothing when it needs one more layer.
    pub(crate) fn cut(
        &self,
        cell: &mut impl Cutting,
        seed: u32,
        buffer: &mut Vec<(f64, u32)>,
    ) -> Option<ExactInput<'_>> {
        self.layers.iter().find_map(|layer| {
            let input = self.layer_input(layer);
            cell.start(seed, input);
            let reach = layer.near_seeds.cut(cell, seed, input, buffer);
            let position = self.seeds[seed as usize];
            let below = position - self.domain.lower() + layer.thickness;
            let above = self.domain.upper() - position + layer.thickness;
            (reach <= below.min(above).min_element()).then_some(input)
        })
    }
}
