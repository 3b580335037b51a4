//! A vertex of a cell of which none is known.

use glam::DVec3;

use crate::clip::clipping::Clipping;
use crate::exact::generator::Generator;
use crate::sites::deepest::Ball;
use crate::sites::search::{ImagesMissing, Layer, RADIUS_MARGIN, Search};
use crate::sites::site_tree::InBox;

/// Planes that a cell is cut by to find one of its vertices, at most: each looks at all vertices of the cell, and what cuts off a
/// single one is found in less time than as many more would take. With 10 to 500 uniform seeds take the same, with 10 those around a
/// heavy one 1.5 % more; seeds on a sphere take a tenth less with 16 than with 64, as all their bisectors meet in its centre.
const MOST_PLANES: usize = 16;

/// The same where something has the seed's own place: then nothing is left in most cases, and with as few as above weights of which some
/// are large take a fourteenth more.
const MOST_PLANES_OF_SWALLOWED: usize = 500;

impl Search<'_> {
    /// The planes of one vertex of a cell, given what it is cut from, and what finds a plane that cuts off the vertex of some planes; none
    /// if the cell is empty.
    pub(crate) fn any_vertex<C: Clipping>(
        &self,
        uncut: impl Fn() -> C,
        seed: u32,
        mut cutter: impl FnMut([Generator; 3]) -> Result<Option<Generator>, ImagesMissing>,
    ) -> Result<Option<[Generator; 3]>, ImagesMissing> {
        let input = self.input();
        for layer in &self.layers {
            // What has the seed's own place for its cell makes short work of it, where nothing is left in the end.
            let at_seed = Ball {
                center: input.seeds[seed as usize],
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
            if cell.radius() < 0.0 || self.security_radius(seed, cell.radius()) <= self.known(layer, seed) {
                return Ok(cell.vertices().first().copied());
            }
        }
        Err(ImagesMissing)
    }

    /// Cuts a cell by what a layer knows, from near to far; false if these are more planes than some number.
    fn cut_by_near(&self, cell: &mut impl Clipping, seed: u32, layer: &Layer, most: usize) -> bool {
        let (input, known) = (self.input(), self.known(layer, seed));
        let mut near = layer.sites.near_first(input.seeds[seed as usize]);
        self.domain().for_each_facet_within(input.seeds[seed as usize], f64::INFINITY, |facet, distance| {
            near.push(facet.generator, (2.0 * distance).powi(2));
        });
        let own_weight = input.weight(seed);
        // As for the security radius, with the weight of a site or of those in a box; where there is no root, they are too light.
        let is_wanted = |radius: f64, squared: f64, weight: f64| {
            let distance = squared.sqrt();
            let root_of = radius * radius + (weight - own_weight);
            let security_radius = radius + root_of.max(0.0).sqrt();
            radius >= 0.0
                && root_of >= 0.0
                && distance <= known
                && distance <= security_radius * RADIUS_MARGIN + self.position_error()
        };
        let mut count = 0;
        while let Some((plane, squared)) =
            near.next(|squared, weight| is_wanted(cell.radius(), squared, weight))
        {
            let is_own = plane.as_site().is_some_and(|site| {
                site == seed || (site as usize >= input.seeds.len() && input.bounds_from_start(seed, site))
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
