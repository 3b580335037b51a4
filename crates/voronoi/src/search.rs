//! The search for the sites around a cell, with as many periodic images as the cell needs.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use crate::candidates::Candidates;
use crate::generator::{Generator, Plane};
use crate::grid::SeedGrid;
use crate::half_space::Intersection;
use crate::images::{Image, ImageTable};
use crate::predicate::ExactInput;
use crate::site_tree::{InBox, SiteTree};
use crate::torus::FaceEnd;
use crate::wide::{Ball, Within};
use crate::{Domain, VoronoiError};

/// Thickness of the first layer of images in units of the mean distance of seeds. Cells of random seeds look no farther
/// than that: a sphere of half the radius without a seed in it has a chance of 1e-14.
const FIRST_THICKNESS: f64 = 4.0;

/// How much thicker each further layer is than the one before.
const LAYER_GROWTH: f64 = 3.0;

/// Covers the rounding of distances and radii, relative to them.
const RADIUS_MARGIN: f64 = 1.0 + 1e-12;

/// Planes that a cell is cut by to find one of its vertices, at most: each looks at all vertices of the cell, and what cuts off a
/// single one is found in less time than as many more would take. With 10 to 500 uniform seeds take the same, with 10 those around a
/// heavy one 1.5 % more; seeds on a sphere take a tenth less with 16 than with 64, as all their bisectors meet in its centre.
const MOST_PLANES: usize = 16;

/// The same where something has the seed's own place: then nothing is left in most cases, and with as few as above weights of which some
/// are large take a fourteenth more.
const MOST_PLANES_OF_SWALLOWED: usize = 500;

/// A cell that is being cut: polyhedron or polygon.
pub(crate) trait Cutting {
    /// A radius around the seed that holds the cell; negative for an empty cell.
    fn radius(&self) -> f64;

    /// Cuts off what lies beyond a plane.
    fn cut(&mut self, generator: Generator, input: ExactInput);

    /// The planes of each vertex, in positive orientation.
    fn vertices(&self) -> Vec<[Generator; 3]>;

    /// The planes of the vertex nearest to the seed.
    fn nearest_vertex(&self) -> Option<[Generator; 3]>;
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
    sites: SiteTree,
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
            let places = (0u32..).take(seeds.len()).collect();
            let sites = search.tree(search.input_with(&images), places, grid);
            search.layers.push(Layer { thickness, images, sites });
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
        let images = before.widened(self.domain, &self.seeds, thickness.min(size));
        if self.seeds.len() + images.list().len() > Generator::MAX_SITES {
            return Err(VoronoiError::TooManySeeds { count: self.seeds.len() + images.list().len() });
        }
        let input = self.input_with(&images);
        let positions: Vec<DVec3> = (0..input.site_count()).map(|site| input.position(site)).collect();
        let mut grid = SeedGrid::new(&positions);
        grid.relieve(&positions);
        let sites = self.tree(input, grid.order.clone(), grid);
        self.layers.push(Layer { thickness, images, sites });
        Ok(())
    }

    /// The sites in boxes, given their order by the blocks of a grid.
    fn tree(&self, input: ExactInput, order: Vec<u32>, grid: SeedGrid) -> SiteTree {
        let weight = self.weights.is_some().then_some(|site| input.weight(site));
        SiteTree::new(order, grid, |site| input.position(site), weight)
    }

    /// The distance from a seed within which all sites lie that can touch or cut the part of its cell within `radius`.
    pub(crate) fn reach(&self, seed: u32, radius: f64) -> f64 {
        // The bisector with a site at distance d lies (d^2 - excess) / (2 d) away.
        let excess = self.largest_weight - self.input().weight(seed);
        let reach = radius + (radius * radius + excess).sqrt();
        reach * RADIUS_MARGIN + self.position_error()
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
    fn known(&self, layer: &Layer, seed: u32) -> f64 {
        let own = self.seeds[seed as usize];
        let to_outside = (own - self.domain.lower()).min(self.domain.upper() - own);
        (to_outside + layer.thickness).min_element()
    }

    /// The first layer that knows all sites at most a reach from a seed.
    fn layer(&self, seed: u32, reach: f64) -> Result<&Layer, ImagesMissing> {
        self.layers.iter().find(|layer| reach <= self.known(layer, seed)).ok_or(ImagesMissing)
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
        let reach = self.reach(seed, to);
        let layer = self.layer(seed, reach)?;
        let with_margin = |radius: f64| radius * RADIUS_MARGIN + self.position_error();
        let within = Within {
            center: self.seeds[seed as usize],
            own_weight: self.input().weight(seed),
            radius: with_margin(to),
        };
        Ok(candidates.push_within(seed, &layer.sites, &within, reach, from.map(with_margin), most))
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
        let layer = self.layer(seed, self.reach(seed, at.distance()))?;
        let ball = Ball {
            center: self.seeds[seed as usize],
            own_weight: self.input().weight(seed),
            vertex: at.position,
            error: at.error + self.position_error(),
            generators: [Generator::site(seed), a, b, c],
        };
        Ok(layer.sites.deepest(&ball, maybe))
    }

    /// The planes of one vertex of a cell, given what it is cut from, and what finds a plane that cuts off the vertex of some planes; none
    /// if the cell is empty.
    pub(crate) fn any_vertex<C: Cutting>(
        &self,
        uncut: impl Fn() -> C,
        seed: u32,
        mut cutter: impl FnMut([Generator; 3]) -> Result<Option<Generator>, ImagesMissing>,
    ) -> Result<Option<[Generator; 3]>, ImagesMissing> {
        let input = self.input();
        for layer in &self.layers {
            // What has the seed's own place for its cell makes short work of it, where nothing is left in the end.
            let at_seed = Ball {
                center: self.seeds[seed as usize],
                own_weight: input.weight(seed),
                vertex: DVec3::ZERO,
                error: self.position_error(),
                generators: [Generator::site(seed); 4],
            };
            if let Some(InBox { site, .. }) = layer.sites.deepest(&at_seed, &mut Vec::new()) {
                let mut cell = uncut();
                cell.cut(site, input);
                self.cut_by_near(&mut cell, seed, layer, MOST_PLANES_OF_SWALLOWED);
                if cell.radius() < 0.0 {
                    return Ok(None);
                }
            }
            let mut cell = uncut();
            if !self.cut_by_near(&mut cell, seed, layer, MOST_PLANES) {
                while let Some(vertex) = cell.nearest_vertex() {
                    match cutter(vertex)? {
                        Some(plane) => cell.cut(plane, input),
                        None => return Ok(Some(vertex)),
                    }
                }
                return Ok(None);
            }
            if cell.radius() < 0.0 || self.reach(seed, cell.radius()) <= self.known(layer, seed) {
                return Ok(cell.vertices().first().copied());
            }
        }
        Err(ImagesMissing)
    }

    /// Cuts a cell by what a layer knows, from near to far; false if these are more planes than some number.
    fn cut_by_near(&self, cell: &mut impl Cutting, seed: u32, layer: &Layer, most: usize) -> bool {
        let (input, known) = (self.input(), self.known(layer, seed));
        let mut near = layer.sites.near_first(self.seeds[seed as usize]);
        input.for_each_facet_within(seed, f64::INFINITY, |facet, distance| {
            near.push(facet.generator, (2.0 * distance).powi(2));
        });
        let own_weight = input.weight(seed);
        // As for the reach, with the weight of a site or of those in a box; where there is no root, they are too light.
        let is_wanted = |radius: f64, squared: f64, weight: f64| {
            let distance = squared.sqrt();
            let root_of = radius * radius + (weight - own_weight);
            let reach = radius + root_of.max(0.0).sqrt();
            radius >= 0.0
                && root_of >= 0.0
                && distance <= known
                && distance <= reach * RADIUS_MARGIN + self.position_error()
        };
        let mut count = 0;
        while let Some((plane, squared)) =
            near.next(|squared, weight| is_wanted(cell.radius(), squared, weight))
        {
            let is_own = plane.as_site().is_some_and(|site| {
                site == seed || (site as usize >= self.seeds.len() && input.bounds_from_start(seed, site))
            });
            let weight = plane.as_site().map_or(own_weight, |site| input.weight(site));
            if !is_own && is_wanted(cell.radius(), squared, weight) {
                count += 1;
                if count > most {
                    return false;
                }
                cell.cut(plane, input);
            }
        }
        true
    }
}
