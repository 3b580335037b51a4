//! Curvature flow of flat fans.

use glam::{DMat3, DVec3};
use rayon::prelude::*;
use voronoi::Side;

use crate::energy::fans::{FanTerms, Fans};
use crate::energy::local_size::LocalSize;
use crate::flow::assembly::sliding_mass;
use crate::flow::boundary_flow::{FREE_TOLERANCE, displaced};
use crate::flow::giving_way::GivingWay;
use crate::flow::growth_law::GrowthLaw;
use crate::flow::pressure_response::CHUNK;
use crate::flow::system::{Parts, System, softened};
use crate::flow::tuning::Tuning;
use crate::flow::volume_constraint::{VolumeConstraint, VolumeGradients};
use crate::mesh::fold::{LARGEST_FOLD, are_apart, is_folded};
use crate::mesh::rounding::{self, last_place};
use crate::solver::rows::{CsrRows, NewRow};
use crate::{Freedom, GrainId, NetworkError};

/// Share of its way to the middle of its boundary that a centre goes at a time while grains grow. With 0.3, a network of a few grains ends in one without
/// volume.
const CENTERING: f64 = 0.2;

/// Fans that flow.
pub(crate) struct FanFlow<'a> {
    pub(crate) fans: &'a Fans,
    pub(crate) motion: Motion<'a>,
    pub(crate) tuning: &'a Tuning,
}

/// By which law fans move.
#[derive(Clone, Copy)]
pub(crate) enum Motion<'a> {
    /// Each cell is to have its volume. Around small ones time is slower.
    Kept { volumes: &'a [f64], size: LocalSize },
    /// By curvature alone: boundaries are as fast as their tension and their mobility make them.
    Free { mobilities: &'a [f64] },
}

/// What a step found where it began.
pub(crate) struct Taken {
    pub(crate) energy: f64,
    /// The pressure of each cell, up to one that is the same for all.
    pub(crate) pressures: Vec<f64>,
}

impl FanFlow<'_> {
    /// A step of the given time.
    ///
    /// What it would fold gives way.
    pub(crate) fn step(&self, points: &mut Vec<DVec3>, time: f64) -> Result<Taken, NetworkError> {
        let Self { fans, tuning, .. } = *self;
        let terms = fans.terms(points, tuning.largest_cotangent);
        let (missing, tolerance) = match self.motion {
            Motion::Kept { volumes, .. } => {
                let now = fans.volumes(volumes.len(), points);
                (volumes.iter().zip(now).map(|(volume, now)| volume - now).collect(), tuning.tolerance)
            }
            Motion::Free { .. } => (Vec::new(), FREE_TOLERANCE),
        };
        let freedoms: Vec<Freedom> = self.of_points(|point| fans.freedom(point));
        let mut parts = self.parts(&terms, freedoms, last_place(points));
        if let Motion::Free { mobilities } = self.motion {
            let law = GrowthLaw::new(fans, points, &terms);
            self.follow(&law, mobilities, &mut parts);
        }
        let system = System::new(parts, time, tolerance);
        let (mut moves, pressures) = system.displacement(&missing);
        let mut moved = Vec::new();
        let neighbors = |point| self.neighbors(point, points);
        GivingWay::new(neighbors, |point| fans.freedom(point as usize)).mend(&mut moves, |moves| {
            moved = displaced(points, moves);
            self.broken_on_way(points, &moved)
        })?;
        *points = moved;
        let pressures = pressures.iter().map(|pressure| pressure / time).collect();
        Ok(Taken { energy: terms.energy, pressures })
    }

    /// Moves centres within their boundaries, which changes no volume: in a step of its own, as it takes no time.
    pub(crate) fn center(&self, points: &mut [DVec3]) {
        let ways: Vec<DVec3> = (0..self.fans.faces.len()).map(|fan| self.to_middle(fan, points)).collect();
        for (fan, way) in ways.into_iter().enumerate() {
            let center = self.fans.center_of(fan);
            points[center] += self.fans.freedom(center).project(way);
        }
    }

    /// As [`Fans::at_point`], but for walls.
    fn inside_at(&self, point: usize) -> impl Iterator<Item = (usize, usize)> {
        self.fans.at_point(point).filter(|(fan, _)| self.fans.wall(*fan).is_none())
    }

    /// The other ends of the edges of a point, fan by fan, and the distances to them.
    fn neighbors(&self, point: u32, points: &[DVec3]) -> Vec<(u32, f64)> {
        let place = |slot| self.fans.position(slot, points);
        let of_slot = |(fan, slot): (usize, usize)| {
            let slots = self.fans.slots_of(fan);
            let (own, count) = (slots[slot], self.fans.rim_len(fan));
            let others = if slot == count {
                (0..count).collect()
            } else {
                vec![(slot + count - 1) % count, (slot + 1) % count, count]
            };
            others.into_iter().map(move |other| {
                let other = slots[other];
                (other.point, place(own).distance(place(other)))
            })
        };
        let neighbors = self.fans.at_point(point as usize).flat_map(of_slot);
        neighbors.filter(|(other, _)| *other != point).collect()
    }

    fn of_points<T: Send>(&self, of_point: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
        (0..self.fans.point_count()).into_par_iter().with_min_len(CHUNK).map(of_point).collect()
    }

    fn parts(&self, terms: &FanTerms, freedoms: Vec<Freedom>, rounding: f64) -> Parts {
        let fans = self.fans;
        let stiffness = |point: usize, row: &mut NewRow<'_, f64>| {
            for (fan, slot) in fans.at_point(point) {
                let slots = fans.slots_of(fan);
                let edges = &terms.stiffness[fans.first_slot(fan)..];
                let count = fans.rim_len(fan);
                let mut add = |slot: usize, stiffness: f64| {
                    let other = slots[slot].point;
                    if other as usize != point {
                        row.add(other, stiffness);
                    }
                };
                if slot == count {
                    (0..count).for_each(|k| add(k, edges[k].to_center));
                } else {
                    let before = (slot + count - 1) % count;
                    add(before, edges[before].rim);
                    add((slot + 1) % count, edges[slot].rim);
                    add(count, edges[slot].to_center);
                }
            }
        };
        let volume_gradients = |point: usize, volume_gradients: &mut VolumeGradients<'_, '_>| {
            for (fan, slot) in self.inside_at(point) {
                let gradient = terms.of_slot[fans.first_slot(fan) + slot].volume_gradient;
                for (side, sign) in fans.sides[fan].into_iter().zip([1.0, -1.0]) {
                    if let Some((cell, _)) = side.cell() {
                        volume_gradients.add(GrainId(cell.0), gradient * sign);
                    }
                }
            }
        };
        let gradient = |point: usize| -> DVec3 {
            fans.at_point(point).map(|(fan, slot)| terms.of_slot[fans.first_slot(fan) + slot].gradient).sum()
        };
        let of_junction = self.tuning.junction_softness.sqrt();
        // Walls have tension here, so that lines on them are junctions too.
        let softness_root = self.of_points(|point| if point < fans.center_of(0) { of_junction } else { 1.0 });
        let constraint = match self.motion {
            Motion::Kept { volumes, .. } => {
                Some((VolumeConstraint::by_group(&freedoms, rounding, volume_gradients), volumes.len()))
            }
            Motion::Free { .. } => None,
        };
        // To transpose a matrix takes one thread.
        let (stiffness, volumes) = rayon::join(
            || CsrRows::made_of_sums(fans.point_count(), stiffness, softened(&softness_root)),
            || constraint.map(|(by_group, grain_count)| VolumeConstraint::new(by_group, grain_count)),
        );
        Parts {
            masses: self.masses(terms),
            gradient: self.of_points(gradient),
            stiffness,
            softness_root,
            freedoms,
            volumes,
            sliding: match self.motion {
                Motion::Kept { .. } => Vec::new(),
                Motion::Free { mobilities } => self.sliding_masses(terms, mobilities),
            },
        }
    }

    /// Makes the forces on points with equal boundaries around lead to the velocities that the law of growth asks for.
    fn follow(&self, law: &GrowthLaw<'_>, mobilities: &[f64], parts: &mut Parts) {
        let Parts { masses, sliding, freedoms, gradient, .. } = parts;
        let speed = |fan: usize| (self.fans.tensions[fan], mobilities[fan]);
        let of_point = |point: usize| {
            let mut speeds = self.inside_at(point).map(|(fan, _)| speed(fan));
            let (tension, mobility) = speeds.next()?;
            if speeds.any(|other| other != (tension, mobility)) {
                return None;
            }
            let velocity = law.velocity(point, freedoms[point])? * (tension * mobility);
            let found = sliding.binary_search_by_key(&point, |(point, _)| *point);
            let slides = found.map_or(DVec3::ZERO, |place| sliding[place].1 * velocity);
            Some(slides - velocity * masses[point])
        };
        let gradients: Vec<Option<DVec3>> = self.of_points(of_point);
        for (gradient, exact) in gradient.iter_mut().zip(gradients) {
            *gradient = exact.unwrap_or(*gradient);
        }
    }

    /// The mass of each point.
    fn masses(&self, terms: &FanTerms) -> Vec<f64> {
        let fans = self.fans;
        let mass = |(fan, slot): (usize, usize)| terms.of_slot[fans.first_slot(fan) + slot].mass;
        match self.motion {
            Motion::Kept { volumes, size } => {
                let of_fan = |fan: usize| {
                    let cells = fans.sides[fan].into_iter().filter_map(Side::cell);
                    let sizes = cells.map(|(cell, _)| size.of_volume(volumes[cell.index()]));
                    sizes.fold(1.0, f64::min)
                };
                let sizes: Vec<f64> =
                    (0..fans.faces.len()).into_par_iter().with_min_len(CHUNK).map(of_fan).collect();
                self.of_points(|point| {
                    let smallest = fans.at_point(point).map(|(fan, _)| sizes[fan]).fold(1.0, f64::min);
                    fans.at_point(point).map(mass).sum::<f64>() / (smallest * smallest)
                })
            }
            // Nothing holds what lies on walls up.
            Motion::Free { mobilities } => {
                self.of_points(|point| self.inside_at(point).map(|at| mass(at) / mobilities[at.0]).sum())
            }
        }
    }

    /// What the masses of points where three boundaries meet are less than isotropic.
    fn sliding_masses(&self, terms: &FanTerms, mobilities: &[f64]) -> Vec<(usize, DMat3)> {
        let fans = self.fans;
        let of_point = |point: usize| {
            let part = |(fan, slot): (usize, usize)| {
                let terms = &terms.of_slot[fans.first_slot(fan) + slot];
                (terms.volume_gradient, terms.mass / mobilities[fan])
            };
            let parts: Vec<(DVec3, f64)> = self.inside_at(point).map(part).collect();
            (parts.len() >= 3).then(|| (point, sliding_mass(parts)))
        };
        let junctions = 0..fans.vertex_count() + fans.lines.len();
        junctions.into_par_iter().with_min_len(CHUNK).filter_map(of_point).collect()
    }

    /// A share of a centre's way to the middle of the triangles around, within their plane: those of a fan are thin where a line is short.
    fn to_middle(&self, fan: usize, points: &[DVec3]) -> DVec3 {
        let slots = self.fans.slots_of(fan);
        let count = slots.len() - 1;
        let place = |slot: usize| self.fans.position(slots[slot], points);
        let center = place(count);
        let (mut way, mut normal, mut weights) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        for (k, of_triangle) in self.fans.normals_of(fan, points).enumerate() {
            // Triangles count by area: no line that comes near catches up with the middle, however many points it has.
            let weight = of_triangle.length();
            let ends = [k, (k + 1) % count].map(|slot| place(slot) - center);
            way += (ends[0] + ends[1]) * weight;
            normal += of_triangle;
            weights += 2.0 * weight;
        }
        let normal = normal.normalize_or_zero();
        let within = way - normal * normal.dot(way);
        within * (CENTERING / weights)
    }

    /// The points of triangles that the way between two places of all points turns too far, or bends too far and more than they were.
    pub(crate) fn broken_on_way(&self, from: &[DVec3], to: &[DVec3]) -> Vec<[u32; 3]> {
        let cosine = |normals: &[DVec3], [a, b]: [usize; 2]| {
            normals[a].normalize_or_zero().dot(normals[b].normalize_or_zero())
        };
        let of_fan = |[before, after]: &mut [Vec<DVec3>; 2], fan: usize| {
            for (normals, points) in [(&mut *before, from), (&mut *after, to)] {
                normals.clear();
                normals.extend(self.fans.normals_of(fan, points));
            }
            let is_turned = |slot: usize| are_apart([before[slot], after[slot]], LARGEST_FOLD);
            let is_bent = |pair: [usize; 2]| {
                is_folded(pair.map(|slot| after[slot]), LARGEST_FOLD)
                    && cosine(after, pair) < cosine(before, pair) - rounding::OF_COSINES
            };
            let slots = self.fans.slots_of(fan);
            let count = slots.len() - 1;
            let mut broken = Vec::new();
            for k in 0..count {
                let next = (k + 1) % count;
                let mut add = |k: usize| {
                    broken.push([k, (k + 1) % count, count].map(|slot| slots[slot].point));
                };
                if is_turned(k) {
                    add(k);
                }
                if is_bent([k, next]) {
                    add(k);
                    add(next);
                }
            }
            broken
        };
        let fans = (0..self.fans.faces.len()).into_par_iter().with_min_len(CHUNK);
        fans.map_init(<[Vec<DVec3>; 2]>::default, of_fan).flatten_iter().collect()
    }
}
