//! The search for the sites around a cell, with as many periodic images as the cell needs.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use crate::exact::face_end::FaceEnd;
use crate::exact::generator::{Generator, Plane};
use crate::exact::half_space::Intersection;
use crate::exact::image::{Image, ImageTable};
use crate::exact::input::ExactInput;
use crate::sites::candidates::Candidates;
use crate::sites::deepest::Ball;
use crate::sites::grid::SeedGrid;
use crate::sites::near::Within;
use crate::sites::site_tree::{InBox, SiteTree};
use crate::{Domain, VoronoiError};

/// Thickness of the first layer of images in units of the mean distance of seeds. Cells of random seeds look no farther
/// than that: a sphere of half the radius without a seed in it has a chance of 1e-14.
const FIRST_THICKNESS: f64 = 4.0;

/// How much thicker each further layer is than the one before.
const LAYER_GROWTH: f64 = 3.0;

/// Covers the rounding of distances and radii, relative to them.
pub(crate) const RADIUS_MARGIN: f64 = 1.0 + 1e-12;

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
    /// The seeds' indices in the user's input.
    ids: Vec<u32>,
    tiles: Vec<Range<u32>>,
    pub(crate) layers: Vec<Layer>,
}

pub(crate) struct Layer {
    /// Along each axis, how far beyond the domain all images are known; infinite where there are no more to know.
    thickness: DVec3,
    images: ImageTable,
    pub(crate) sites: SiteTree,
}

/// What is left of a search when all cells are cut.
#[derive(Debug)]
pub(crate) struct Names {
    /// The seeds' indices in the user's input.
    pub(crate) ids: Vec<u32>,
    images: ImageTable,
}

impl Names {
    /// What a [code](Search::code) stands for.
    pub(crate) fn end_of(&self, code: u32) -> FaceEnd {
        if (code as usize) < self.ids.len() {
            FaceEnd::cell(code)
        } else {
            end(&self.ids, &self.images, Generator(code))
        }
    }
}

fn end(ids: &[u32], images: &ImageTable, generator: Generator) -> FaceEnd {
    match generator.plane() {
        Plane::Side(wall) | Plane::Facet(wall) => FaceEnd::Wall(wall),
        Plane::Site(site) => {
            let image = images.image(ids.len(), site);
            FaceEnd::Cell(Image { seed: ids[image.seed as usize], ..image })
        }
    }
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
        let canonical: Vec<DVec3> = seeds.par_iter().map(canonical).collect();
        let mut grid = SeedGrid::new(&canonical);
        if let Some((first, second)) = grid.duplicates(&canonical) {
            let [first, second] = [first, second].map(|id| id as usize);
            return Err(VoronoiError::DuplicateSeeds { first, second, position: seeds[first] });
        }
        grid.relieve(&canonical);
        let ids = grid.order.clone();
        drop(canonical);
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
            search.widen()?;
        } else {
            let (thickness, images) = (DVec3::INFINITY, ImageTable::default());
            let indices = (0u32..).take(seeds.len()).collect();
            let sites = search.tree(&search.seeds, search.input_with(&images), indices, grid);
            search.layers.push(Layer { thickness, images, sites });
        }
        Ok(search)
    }

    /// The domain that is divided up.
    pub(crate) fn domain(&self) -> &'a Domain {
        self.domain
    }

    /// The ranges of seeds that make up compact parts of space.
    pub(crate) fn tiles(&self) -> &[Range<u32>] {
        &self.tiles
    }

    /// Of each seed in the user's order, its index in this one.
    pub(crate) fn indices(&self) -> Vec<u32> {
        let mut indices = vec![0; self.ids.len()];
        for (index, id) in (0u32..).zip(&self.ids) {
            indices[*id as usize] = index;
        }
        indices
    }

    /// What lies beyond a generator's plane, in the user's numbering of cells.
    #[inline]
    pub(crate) fn end(&self, generator: Generator) -> FaceEnd {
        if let Some(id) = self.ids.get(generator.0 as usize) {
            return FaceEnd::cell(*id);
        }
        end(&self.ids, &self.layers[self.layers.len() - 1].images, generator)
    }

    /// A generator as a number that is the user's own for a seed.
    pub(crate) fn code(&self, generator: Generator) -> u32 {
        self.ids.get(generator.0 as usize).copied().unwrap_or(generator.0)
    }

    /// The seeds in this order, and what their numbers mean to the user.
    pub(crate) fn into_names(mut self) -> (Vec<DVec3>, Names) {
        let images = self.layers.pop().map(|layer| layer.images).unwrap_or_default();
        (self.seeds, Names { ids: self.ids, images })
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
        ExactInput { frame: &self.domain.frame, seeds: &self.seeds, weights: self.weights.as_deref(), images }
    }

    /// Adds a layer of images, until there are enough for every cell.
    ///
    /// # Errors
    /// [`VoronoiError::TooManySeeds`] when seeds and images have more numbers than there are.
    pub(crate) fn widen(&mut self) -> Result<(), VoronoiError> {
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
        let images = before.widened(&self.domain.frame, &self.seeds, thickness.min(size));
        if self.seeds.len() + images.list().len() > Generator::MAX_SITES {
            return Err(VoronoiError::TooManySeeds { count: self.seeds.len() + images.list().len() });
        }
        let input = self.input_with(&images);
        let positions: Vec<DVec3> =
            (0..input.site_count()).into_par_iter().map(|site| input.position(site)).collect();
        let mut grid = SeedGrid::of_ordered(&positions);
        grid.relieve(&positions);
        let sites = self.tree(&positions, input, grid.order.clone(), grid);
        self.layers.push(Layer { thickness, images, sites });
        Ok(())
    }

    /// The sites in boxes, given their positions and their order by the blocks of a grid.
    fn tree(&self, positions: &[DVec3], input: ExactInput, order: Vec<u32>, grid: SeedGrid) -> SiteTree {
        let weight = self.weights.is_some().then_some(|site| input.weight(site));
        SiteTree::new(order, grid, |site| positions[site as usize], weight)
    }

    /// The distance from a seed within which all sites lie that can touch or cut the part of its cell within `radius`.
    pub(crate) fn security_radius(&self, seed: u32, radius: f64) -> f64 {
        // The bisector with a site at distance d lies (d^2 - excess) / (2 d) away.
        let excess = self.largest_weight - self.input().weight(seed);
        let security_radius = radius + (radius * radius + excess).sqrt();
        security_radius * RADIUS_MARGIN + self.position_error()
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

    /// How far from a seed a layer knows all sites.
    pub(crate) fn known(&self, layer: &Layer, seed: u32) -> f64 {
        let own = self.seeds[seed as usize];
        let to_outside = (own - self.domain.lower()).min(self.domain.upper() - own);
        (to_outside + layer.thickness).min_element()
    }

    /// The first layer that knows all sites at most a security radius from a seed.
    fn layer(&self, seed: u32, security_radius: f64) -> Result<&Layer, ImagesMissing> {
        self.layers.iter().find(|layer| security_radius <= self.known(layer, seed)).ok_or(ImagesMissing)
    }

    /// Adds the bisectors of a seed with sites that come nearer than the second of two radii, but not nearer than the first if there
    /// is one. False if more than some number of sites would have to be looked at: then none is added.
    pub(crate) fn gather(
        &self,
        candidates: &mut Candidates,
        seed: u32,
        from: Option<f64>,
        to: f64,
        most: usize,
    ) -> Result<bool, ImagesMissing> {
        let security_radius = self.security_radius(seed, to);
        let layer = self.layer(seed, security_radius)?;
        let with_margin = |radius: f64| radius * RADIUS_MARGIN + self.position_error();
        let within = Within {
            center: self.seeds[seed as usize],
            own_weight: self.input().weight(seed),
            radius: with_margin(to),
        };
        Ok(candidates.push_within(seed, &layer.sites, &within, security_radius, from.map(with_margin), most))
    }

    /// Of the sites that certainly cut off a vertex of some planes of a seed's cell, the one that does so farthest; else none, and
    /// all that may. The vertex is known up to an error.
    pub(crate) fn farthest_cut(
        &self,
        seed: u32,
        [a, b, c]: [Generator; 3],
        at: &Intersection,
        maybe: &mut Vec<Generator>,
    ) -> Result<Option<InBox<'_>>, ImagesMissing> {
        let layer = self.layer(seed, self.security_radius(seed, at.distance()))?;
        let ball = Ball {
            center: self.seeds[seed as usize],
            own_weight: self.input().weight(seed),
            vertex: at.position,
            error: at.error + self.position_error(),
            generators: [Generator::site(seed), a, b, c],
        };
        Ok(layer.sites.deepest(&ball, maybe))
    }
}
