//! Velocities by which each grain grows by the law of MacPherson and Srolovitz, however coarse its triangles are.
//!
//! Under curvature flow with unit tension and mobility the volume of a grain changes at the rate `-sum of l (t - t0)`, over the edges of its triangles, with their
//! lengths l and their exterior angles t. Edges inside a boundary have `t0 = 0`, those of three boundaries `pi / 3`, and those of a boundary and a wall
//! `pi / 2` (MacPherson and Srolovitz 2007). Half of each term belongs to either end of the edge. So at each point there is one rate for each grain around
//! it, and their sum is 0: one condition inside a boundary, two on a triple line, three at a quadruple point. That is as many as the point has ways to go,
//! other than along its boundary or line (Lazar, Mason, MacPherson and Srolovitz 2011, "A more accurate three-dimensional grain growth algorithm").
//!
//! The gradient of the area leads to the same rates to first order in the angles only: those of coarse fans are off by 3 %.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3};

use glam::{DMat3, DVec3};
use rayon::prelude::*;
use voronoi::{CellId, Translation};

use crate::Freedom;
use crate::energy::fans::{FanTerms, Fans};
use crate::flow::pressure_response::CHUNK;

/// Least determinant of the conditions at a point, in units of the product of their lengths, by which its velocity is taken to be determined.
const LEAST_DETERMINANT: f64 = 0.05;

/// Fans where their points are.
pub(crate) struct GrowthLaw<'a> {
    fans: &'a Fans,
    terms: &'a FanTerms,
    /// Of each slot, for both sides of its fan: `l (t - t0)` of the edge to the next slot of the rim. Not a number where the law does not tell.
    of_rim: Vec<[f64; 2]>,
    /// Of each slot of a rim, `l t` of its edge to the centre, for the first side of its fan.
    of_spoke: Vec<f64>,
}

/// A grain around a point.
struct Around {
    grain: CellId,
    /// By how many periods its own place is away from where it is here.
    periods: Translation,
    /// Volume that the grain gains per displacement of the point.
    gain: DVec3,
    /// What of its rate belongs to the point.
    rate: f64,
}

/// A triangle at an edge of boundaries, as a grain beside it sees it from outside.
struct Facet {
    /// The other end of the edge, and by how many periods it is away from its own place.
    end: (u32, Translation),
    grain: CellId,
    /// As of [`Around`].
    periods: Translation,
    is_wall: bool,
    normal: DVec3,
    /// The edge as it runs around the triangle.
    edge: DVec3,
    /// The slot at which the edge begins there, and which side of the fan the grain is.
    place: (usize, usize),
}

impl<'a> GrowthLaw<'a> {
    /// The law for fans with these points, given their terms too.
    pub(crate) fn new(fans: &'a Fans, points: &[DVec3], terms: &'a FanTerms) -> Self {
        let all = || (0..fans.faces.len()).into_par_iter().with_min_len(CHUNK);
        // Of each slot; of centres nothing.
        let normals_of = |fan: usize| fans.normals_of(fan, points).chain([DVec3::ZERO]);
        let normals: Vec<DVec3> = all().flat_map_iter(normals_of).collect();
        let spokes = |fan: usize| {
            let (slots, normals) = (fans.slots_of(fan), &normals[fans.first_slot(fan)..]);
            let count = slots.len() - 1;
            let place = |slot: usize| fans.position(slots[slot], points);
            let spoke = |slot: usize| place(slot) - place(count);
            let of_slot =
                move |slot| bend(spoke(slot), [normals[slot], normals[(slot + count - 1) % count]], 0.0);
            (0..count).map(of_slot).chain([0.0]).collect::<Vec<f64>>()
        };
        let of_spoke: Vec<f64> = all().flat_map_iter(spokes).collect();
        let mut of_rim = vec![[0.0; 2]; of_spoke.len()];
        let lines = (0..fans.lines.len()).into_par_iter().with_min_len(CHUNK);
        let rims: Vec<_> = lines.flat_map_iter(|line| rims_at(line, fans, points, &normals)).collect();
        rims.into_iter().for_each(|((slot, side), value)| of_rim[slot][side] = value);
        Self { fans, terms, of_rim, of_spoke }
    }

    /// The velocity of a point with this freedom, for unit tension and mobility. None where that is not determined: where more boundaries meet than three at a line
    /// (beside walls one) or six at a point, and in corners that are nearly flat.
    pub(crate) fn velocity(&self, point: usize, freedom: Freedom) -> Option<DVec3> {
        let fans = self.fans;
        let mut around: Vec<Around> = Vec::with_capacity(4);
        for (fan, slot) in fans.at_point(point) {
            let first = fans.first_slot(fan);
            let count = fans.rim_len(fan);
            let is_wall = fans.wall(fan).is_some();
            let spokes = &self.of_spoke[first..first + count];
            let bend = if slot == count { spokes.iter().sum() } else { spokes[slot] };
            let (gain, bend) = if is_wall {
                (DVec3::ZERO, 0.0)
            } else {
                (self.terms.of_slot[first + slot].volume_gradient, bend)
            };
            for (side, sign) in [1.0, -1.0].into_iter().enumerate() {
                let Some((grain, periods)) = grain_at(fans, fan, slot, side) else { continue };
                let found = around.iter().position(|other| (other.grain, other.periods) == (grain, periods));
                let of_grain = found.unwrap_or_else(|| {
                    around.push(Around { grain, periods, gain: DVec3::ZERO, rate: 0.0 });
                    around.len() - 1
                });
                let of_grain = &mut around[of_grain];
                of_grain.gain += gain * sign;
                of_grain.rate -= 0.5 * sign * bend;
                if slot < count {
                    // The grain has each edge of the rim in two boundaries.
                    let before = (slot + count - 1) % count;
                    of_grain.rate -=
                        0.25 * (self.of_rim[first + slot][side] + self.of_rim[first + before][side]);
                }
            }
        }
        // What the last one gains all others lose.
        let (_, conditions) = around.split_last()?;
        let gain = |number: usize| freedom.project(conditions[number].gain);
        let rate = |number: usize| conditions[number].rate;
        let (rows, rates) = match conditions.len() {
            1 => {
                let across = gain(0).any_orthogonal_vector();
                ([gain(0), across, gain(0).cross(across)], DVec3::new(rate(0), 0.0, 0.0))
            }
            2 => ([gain(0), gain(1), gain(0).cross(gain(1))], DVec3::new(rate(0), rate(1), 0.0)),
            3 => ([0, 1, 2].map(gain), DVec3::new(rate(0), rate(1), rate(2))),
            _ => return None,
        };
        let matrix = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
        let scale: f64 = rows.iter().map(|row| row.length()).product();
        let is_determined = rates.is_finite() && matrix.determinant().abs() > LEAST_DETERMINANT * scale;
        is_determined.then(|| matrix.inverse() * rates)
    }
}

/// `l (t - t0)` of the edges of a line: for each boundary that it is in, its slots, and both sides.
fn rims_at(line: usize, fans: &Fans, points: &[DVec3], normals: &[DVec3]) -> Vec<((usize, usize), f64)> {
    let mut facets = Vec::with_capacity(12);
    for (fan, slot) in fans.at_point(fans.point_of_line(line)) {
        let (slots, first) = (fans.slots_of(fan), fans.first_slot(fan));
        let count = slots.len() - 1;
        let (before, next) = ((slot + count - 1) % count, (slot + 1) % count);
        for (other, start, run) in [(next, slot, 1.0), (before, before, -1.0)] {
            let place = |slot: usize| fans.position(slots[slot], points);
            let end = (slots[other].point, slots[other].translation - slots[slot].translation);
            let edge = (place(other) - place(slot)) * run;
            for (side, sign) in [1.0, -1.0].into_iter().enumerate() {
                let Some((grain, periods)) = grain_at(fans, fan, slot, side) else { continue };
                facets.push(Facet {
                    end,
                    grain,
                    periods,
                    is_wall: fans.wall(fan).is_some(),
                    normal: normals[first + start] * sign,
                    edge: edge * sign,
                    place: (first + start, side),
                });
            }
        }
    }
    facets.sort_unstable_by_key(|facet| (facet.end, facet.grain, facet.periods, facet.place));
    let mut values = Vec::with_capacity(facets.len());
    for facets in facets.chunk_by(|one, other| one.end == other.end) {
        let walls = facets.iter().filter(|facet| facet.is_wall).count();
        // Along an edge of the domain, where no boundary meets it, nothing moves.
        let at_rest = match (facets.len() - walls, walls) {
            (0, _) => continue,
            (6, 0) => FRAC_PI_3,
            (2, 2) => FRAC_PI_2,
            _ => f64::NAN,
        };
        for of_grain in facets.chunk_by(|one, other| (one.grain, one.periods) == (other.grain, other.periods))
        {
            let value = match of_grain {
                [one, other] => bend(one.edge, [one.normal, other.normal], at_rest),
                _ => f64::NAN,
            };
            values.extend(of_grain.iter().map(|facet| (facet.place, value)));
        }
    }
    values
}

/// The grain on a side of a fan, and by how many periods its own place is away from where it is at a slot; none beyond walls.
fn grain_at(fans: &Fans, fan: usize, slot: usize, side: usize) -> Option<(CellId, Translation)> {
    let (grain, translation) = fans.sides[fan][side].cell()?;
    Some((grain, translation - fans.slots_of(fan)[slot].translation))
}

/// The length of an edge times the angle between the normals of its triangles, of which the first one has the edge run around it; positive where convex. Less the angle at rest.
fn bend(edge: DVec3, [first, second]: [DVec3; 2], at_rest: f64) -> f64 {
    let length = edge.length();
    let angle = edge.dot(first.cross(second)).atan2(first.dot(second) * length) - at_rest;
    length * angle
}

#[cfg(test)]
mod tests {
    use glam::BVec3;
    use voronoi::{Domain, Tessellation};

    use super::*;
    use crate::energy::shape::Shape;
    use crate::{CellComplex, Junctions, Network, measure_network};

    /// Sixteen cells around a lattice whose cells have fourteen faces, with fans whose points are a little off the flat faces.
    fn bulging(domain: &Domain) -> (CellComplex, Fans, Vec<DVec3>) {
        let off = |k: u32| (DVec3::new(0.8192, 0.6711, 0.5497) * f64::from(k)).fract() - 0.5;
        let corner = |k: u32| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2 & 1));
        let place = |k: u32| 0.5 * corner(k) + DVec3::splat(0.1 + 0.25 * f64::from(k >> 3));
        let seeds: Vec<DVec3> = (0..16).map(|k| place(k) + off(k) * 0.04).collect();
        let mut complex = CellComplex::from(&Tessellation::new(domain, &seeds).expect("valid seeds"));
        let fans = Fans::new(&complex, &|_| 1.0);
        let mut points = Shape::default().points(&complex, &fans);
        for (number, point) in (0u32..).zip(points.iter_mut()) {
            *point += fans.freedom(number as usize).project(off(number) * 0.02);
        }
        complex.vertices.copy_from_slice(&points[..fans.vertex_count()]);
        (complex, fans, points)
    }

    /// How fast each grain gains volume, where all of its points have velocities.
    fn gains(complex: &CellComplex, fans: &Fans, points: &[DVec3]) -> Vec<Option<f64>> {
        let terms = fans.terms(points, 50.0);
        let law = GrowthLaw::new(fans, points, &terms);
        let mut gains = vec![Some(0.0); complex.cell_count()];
        for point in 0..points.len() {
            let velocity = law.velocity(point, fans.freedom(point));
            for (fan, slot) in fans.at_point(point) {
                let gradient = terms.of_slot[fans.first_slot(fan) + slot].volume_gradient;
                for (side, sign) in [1.0, -1.0].into_iter().enumerate() {
                    let Some((grain, _)) = grain_at(fans, fan, slot, side) else { continue };
                    let by = velocity.map(|velocity| sign * gradient.dot(velocity));
                    let gain = &mut gains[grain.index()];
                    *gain = gain.zip(by).map(|(gain, by)| gain + by);
                }
            }
        }
        gains
    }

    #[test]
    fn coarse_grains_grow_by_the_law_exactly() {
        let (complex, fans, points) = bulging(&Domain::unit_cube().with_periods(BVec3::TRUE));
        let gains = gains(&complex, &fans, &points);
        let (cells, control_points) = Shape::new(&fans, &points).cells(&complex);
        let (network, _) = Network::new(&cells, Junctions::Crease, 0).expect("a small network");
        let measures = measure_network(&network, &control_points).in_space().expect("surfaces");
        assert_eq!(measures.grains.len(), 16);
        for grain in &measures.grains {
            let law = grain.growth_rate.expect("no walls");
            let gain = gains[grain.grain.index()].expect("three boundaries at a line, six at a point");
            assert!((gain - law).abs() < 1e-9 * grain.mean_width, "{gain}, not {law}");
        }
    }

    /// A flat boundary between two grains leans: at walls it turns upright.
    #[test]
    fn boundaries_turn_upright_at_walls() {
        let seeds = [DVec3::new(0.3, 0.5, 0.45), DVec3::new(0.7, 0.5, 0.55)];
        let complex =
            CellComplex::from(&Tessellation::new(&Domain::unit_cube(), &seeds).expect("valid seeds"));
        let fans = Fans::new(&complex, &|_| 1.0);
        let points = Shape::default().points(&complex, &fans);
        let terms = fans.terms(&points, 50.0);
        let law = GrowthLaw::new(&fans, &points, &terms);
        let lean = 0.25f64.atan();
        let mut moved = 0;
        for (line, ends) in fans.lines.iter().enumerate() {
            let point = fans.point_of_line(line);
            let (height, freedom) = (points[point].z, fans.freedom(point));
            let is_of_boundary = fans.at_point(point).any(|(fan, _)| fans.wall(fan).is_none());
            if !is_of_boundary || (height > 0.0 && height < 1.0) {
                continue;
            }
            let gain: DVec3 = fans
                .at_point(point)
                .filter(|(fan, _)| fans.wall(*fan).is_none())
                .map(|(fan, slot)| terms.of_slot[fans.first_slot(fan) + slot].volume_gradient)
                .sum();
            let velocity = law.velocity(point, freedom).expect("one boundary on a wall");
            let length = complex.vertices[ends.start as usize].distance(complex.position(ends.end));
            // The other half belongs to the ends of the line.
            let expected = if height == 0.0 { -lean } else { lean } * length / 2.0;
            assert!((gain.dot(velocity) - expected).abs() < 1e-9, "{height}: {velocity}");
            assert_eq!(velocity.z, 0.0);
            moved += 1;
        }
        assert_eq!(moved, 2);
    }
}
