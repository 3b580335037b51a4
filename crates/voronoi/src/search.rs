//! The search for the sites around a cell, with as many periodic images as the cell needs.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use crate::candidates::Candidates;
use crate::generator::{Generator, Plane};
use crate::grid::SeedGrid;
use crate::images::{Image, ImageTable};
use crate::predicate::ExactInput;
use crate::torus::FaceEnd;
use crate::{Domain, VoronoiError};

/// Thickness of the first layer of images in units of the mean distance of seeds. Cells of random seeds look no farther
/// than that: a sphere of half the radius without a seed in it has a chance of 1e-14.
const FIRST_THICKNESS: f64 = 4.0;

/// How much thicker each further layer is than the one before.
const LAYER_GROWTH: f64 = 3.0;

/// Covers the rounding of distances and radii, relative to them.
const RADIUS_MARGIN: f64 = 1.0 + 1e-12;

/// Growth of the reach from one round of the search around a cell to the next: twice the volume.
const REACH_GROWTH: f64 = 1.26;

/// A cell that is being cut: polyhedron or polygon.
pub(crate) trait Cutting {
    /// A radius around the seed that holds the cell; negative for an empty cell.
    fn radius(&self) -> f64;

    /// Cuts off what lies beyond a plane.
    fn cut(&mut self, generator: Generator, input: ExactInput);

    /// The planes of each vertex, in positive orientation.
    fn vertices(&self) -> Vec<[Generator; 3]>;
}

/// A cell needs images of seeds that are farther away than those known.
#[derive(Debug)]
pub(crate) struct ImagesMissing;

/// Seeds, sorted in space, and the images around them. Each layer's images begin with those of the one before, so sites keep
/// their numbers.
pub(crate) struct Search<'a> {
    domain: &'a Domain,
    seeds: Vec<DVec3>,
    weights: Option<Vec<f64>>,
    largest_weight: f64,
    /// The seeds' places in the user's input.
    ids: Vec<u32>,
    tiles: Vec<Range<u32>>,
    layers: Vec<Layer>,
}

struct Layer {
    /// Along each axis, how far beyond the domain all images are known; infinite where there are no more to know.
    thickness: DVec3,
    images: ImageTable,
    grid: SeedGrid,
}

impl<'a> Search<'a> {
    /// Sorts the seeds.
    ///
    /// # Errors
    /// [`VoronoiError::DuplicateSeeds`].
    pub(crate) fn new(
        domain: &'a Domain,
        seeds: &[DVec3],
        weights: Option<&[f64]>,
    ) -> Result<Self, VoronoiError> {
        // Periodic walls are one.
        let canonical = |seed: &DVec3| {
            DVec3::select(domain.periodic() & seed.cmpeq(domain.upper()), domain.lower(), *seed)
        };
        let grid = SeedGrid::new(seeds.par_iter().map(canonical).collect());
        if let Some((first, second)) = grid.duplicates() {
            let [first, second] = [first, second].map(|id| id as usize);
            return Err(VoronoiError::DuplicateSeeds { first, second, position: seeds[first] });
        }
        let ids = grid.order.clone();
        let weights: Option<Vec<f64>> =
            weights.map(|weights| ids.iter().map(|id| weights[*id as usize]).collect());
        let largest_weight = match &weights {
            Some(weights) => weights.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            None => 0.0,
        };
        let mut search = Self {
            domain,
            seeds: ids.par_iter().map(|id| seeds[*id as usize]).collect(),
            weights,
            largest_weight,
            ids,
            tiles: grid.tiles().to_vec(),
            layers: Vec::new(),
        };
        if domain.is_periodic() {
            search.widen();
        } else {
            let (thickness, images) = (DVec3::INFINITY, ImageTable::default());
            search.layers.push(Layer { thickness, images, grid: grid.renumbered() });
        }
        Ok(search)
    }

    /// The ranges of seeds that make up compact parts of space.
    pub(crate) fn tiles(&self) -> &[Range<u32>] {
        &self.tiles
    }

    /// The seeds' places in the user's input.
    pub(crate) fn ids(&self) -> &[u32] {
        &self.ids
    }

    /// Of each seed in the user's order, its place in this one.
    pub(crate) fn places(&self) -> Vec<u32> {
        let mut places = vec![0; self.ids.len()];
        for (place, id) in (0u32..).zip(&self.ids) {
            places[*id as usize] = place;
        }
        places
    }

    /// What lies beyond a generator's plane, in the user's numbering of cells.
    pub(crate) fn end(&self, generator: Generator) -> FaceEnd {
        match generator.plane() {
            Plane::Side(wall) | Plane::Facet(wall) => FaceEnd::Wall(wall),
            Plane::Site(site) => {
                let image = self.input().image(site);
                FaceEnd::Cell(Image { seed: self.ids[image.seed as usize], ..image })
            }
        }
    }

    /// Whether what lies beyond a seed's plane comes before what lies beyond another generator's, in the user's numbering.
    #[inline]
    pub(crate) fn is_before(&self, seed: Generator, other: Generator) -> bool {
        match self.ids.get(other.0 as usize) {
            Some(id) => self.ids[seed.0 as usize] < *id,
            None => self.end(seed) < self.end(other),
        }
    }

    /// The seeds and all images that were looked at.
    pub(crate) fn input(&self) -> ExactInput<'_> {
        self.input_with(&self.layers[self.layers.len() - 1].images)
    }

    fn input_with<'b>(&'b self, images: &'b ImageTable) -> ExactInput<'b> {
        ExactInput { domain: self.domain, seeds: &self.seeds, weights: self.weights.as_deref(), images }
    }

    /// Adds a layer of images, until there are enough for every cell.
    pub(crate) fn widen(&mut self) {
        let size = self.domain.size();
        let spacing = (self.domain.measure() / self.seeds.len() as f64).powf(1.0 / self.domain.axes() as f64);
        let exponent = i32::try_from(self.layers.len()).unwrap_or(i32::MAX);
        let wanted = FIRST_THICKNESS * spacing * LAYER_GROWTH.powi(exponent);
        let thickness = DVec3::from_array([0, 1, 2].map(|axis| {
            // Below half a period, so that a cell which does not yet know its own image cannot pass as finished.
            let is_partial = self.domain.periodic().test(axis) && wanted < 0.45 * size[axis];
            if is_partial { wanted } else { f64::INFINITY }
        }));
        let none = ImageTable::default();
        let before = self.layers.last().map_or(&none, |layer| &layer.images);
        let images = before.widened(self.domain, &self.seeds, thickness.min(size));
        let input = self.input_with(&images);
        let grid = SeedGrid::new((0..input.site_count()).map(|site| input.position(site)).collect());
        self.layers.push(Layer { thickness, images, grid });
    }

    /// The distance from a seed within which all sites lie that can touch or cut the part of its cell within `radius`.
    pub(crate) fn reach(&self, seed: u32, radius: f64) -> f64 {
        // The bisector with a site at distance d lies (d^2 - excess) / (2 d) away.
        let reach = radius + (radius * radius + self.excess_weight(seed)).sqrt();
        reach * RADIUS_MARGIN + self.position_error()
    }

    /// A radius such that [`Self::reach`] is at most `reach`; negative if there is none.
    pub(crate) fn radius(&self, seed: u32, reach: f64) -> f64 {
        let distance = (reach - self.position_error()) / RADIUS_MARGIN;
        (distance * distance - self.excess_weight(seed)) / (2.0 * distance * RADIUS_MARGIN)
    }

    /// By how much the largest weight exceeds that of a seed.
    fn excess_weight(&self, seed: u32) -> f64 {
        if self.weights.is_none() { 0.0 } else { self.largest_weight - self.input().weight(seed) }
    }

    /// The number of the first image.
    pub(crate) fn first_image(&self) -> u32 {
        u32::try_from(self.seeds.len()).expect("site ids were checked to fit")
    }

    /// Bound on the rounding of sites' positions: those of images are rounded.
    pub(crate) fn position_error(&self) -> f64 {
        if self.domain.is_periodic() {
            1e-15 * self.domain.lower().abs().max(self.domain.upper().abs()).max_element()
        } else {
            0.0
        }
    }

    /// Next reach of a search that has come to `reach` and needs to go to `wanted`.
    pub(crate) fn grow(&self, reach: f64, wanted: f64) -> f64 {
        wanted.min((reach * REACH_GROWTH).max(self.layers[0].grid.block_size()))
    }

    /// The first layer that knows all sites at most `to` from a seed.
    fn layer(&self, seed: u32, to: f64) -> Result<&Layer, ImagesMissing> {
        let own = self.seeds[seed as usize];
        let to_outside = (own - self.domain.lower()).min(self.domain.upper() - own);
        let knows_all = |layer: &&Layer| to <= (to_outside + layer.thickness).min_element();
        self.layers.iter().find(knows_all).ok_or(ImagesMissing)
    }

    /// Adds the bisectors of a seed with all sites further than `from` and at most `to` away.
    pub(crate) fn gather(
        &self,
        candidates: &mut Candidates,
        seed: u32,
        [from, to]: [f64; 2],
    ) -> Result<(), ImagesMissing> {
        let layer = self.layer(seed, to)?;
        let own = self.seeds[seed as usize];
        let first = candidates.len();
        let squares = [if from < 0.0 { -1.0 } else { from * from }, to * to];
        candidates.push_within(seed, own, &layer.grid, to, squares);
        if self.weights.is_some() {
            let input = self.input();
            let own_weight = input.weight(seed);
            candidates.shift_offsets(first, |generator| {
                let shift = 0.5 * (own_weight - input.weight(generator.0));
                (shift, (input.position(generator.0) - own).length_squared())
            });
        }
        Ok(())
    }

    /// Visits all sites further than `from` and at most `to` from a seed but itself and those that its cell begins with, with
    /// the square of the distance.
    fn for_each_within(
        &self,
        seed: u32,
        [from, to]: [f64; 2],
        mut visit: impl FnMut(u32, f64),
    ) -> Result<(), ImagesMissing> {
        let input = self.input();
        let grid = &self.layer(seed, to)?.grid;
        grid.for_each_within(self.seeds[seed as usize], from, to, |site, _, squared| {
            let is_image = site as usize >= self.seeds.len();
            if site != seed && !(is_image && input.bounds_from_start(seed, site)) {
                visit(site, squared);
            }
        });
        Ok(())
    }

    /// The planes of one vertex of the cell that a cut with all near sites makes of `cell`; none if that is empty.
    pub(crate) fn any_vertex(
        &self,
        mut cell: impl Cutting,
        seed: u32,
    ) -> Result<Option<[Generator; 3]>, ImagesMissing> {
        let mut near = Vec::new();
        let mut reach = -1.0;
        while cell.radius() >= 0.0 && self.reach(seed, cell.radius()) > reach {
            let next = self.grow(reach, self.reach(seed, cell.radius()));
            near.clear();
            self.for_each_within(seed, [reach, next], |site, squared| {
                near.push((squared, Generator::site(site)));
            })?;
            self.input().for_each_facet_within(seed, [reach, next], |facet, doubled| {
                near.push((doubled * doubled, facet.generator));
            });
            near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            for (squared, generator) in &near {
                if cell.radius() < 0.0 || squared.sqrt() > self.reach(seed, cell.radius()) {
                    break;
                }
                cell.cut(*generator, self.input());
            }
            reach = next;
        }
        Ok(cell.vertices().first().copied())
    }
}
