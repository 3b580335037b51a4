//! What a flow does in the end about thin triangles.

use std::collections::{HashMap, HashSet};

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;
use subzero::VertexRule;

use crate::flow::boundary_flow::{Flow, LevelSectors, Room};
use crate::flow::thin_triangles::{STEPS, Widened};
use crate::mesh::boundary_elements::BoundaryElements;
use crate::mesh::id::id;
use crate::mesh::level_points::LevelPoints;
use crate::mesh::triangle_quality::squared_sine;
use crate::{BoundaryId, Mesh, TriangleQuality, Volumes};

/// Smallest angle, in units of the bound, that thin triangles are brought to: the volumes, which are made right after that, take some of it.
const WIDE: f64 = 1.15;

/// What moves to make triangles wider.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Moving {
    /// Points inside boundaries.
    Inside,
    /// Also points on the lines beside the triangle.
    Lines,
}

impl<'a> Flow<'a> {
    /// Makes thin triangles of the finest level wide, as far as nothing folds; `surface` are the points of that level. Points on lines move as long
    /// as that leaves fewer of them.
    pub(super) fn widen_all(
        &self,
        points: &mut Vec<DVec3>,
        surface: &LevelPoints<'_>,
        finest: &LevelSectors<'_>,
    ) {
        // Where grains grow, what that does to volumes would count as growth.
        if self.volumes != Volumes::Kept {
            return;
        }
        let mut thin = self.thin_triangles(surface);
        let mut budget = self.tuning.widening * self.network.levels()[self.level].element_count() as f64;
        let mut moving = Moving::Inside;
        while !thin.is_empty() {
            check_cancelled();
            let count = thin.len();
            let movable = self.movable_points(&thin, moving);
            let mut moved = points.clone();
            if self.widen(&mut moved, &movable, &mut budget)
                && let Some((right, restored)) = self.unfolded(points, moved, &movable, finest)
            {
                *points = right;
                thin = self.thin_triangles(&restored);
            }
            if moving == Moving::Lines && thin.len() >= count {
                break;
            }
            moving = Moving::Lines;
        }
    }

    /// Points that moved, with the volumes made right, and the finest level; groups of them stay where they were if that folds.
    fn unfolded(
        &self,
        points: &[DVec3],
        mut moved: Vec<DVec3>,
        groups: &[Vec<u32>],
        finest: &LevelSectors<'_>,
    ) -> Option<(Vec<DVec3>, LevelPoints<'a>)> {
        for _ in 0..2 {
            let mut right = moved.clone();
            let restored = self.restored(&mut right).ok()?;
            let folded = self.folded_places(&restored, finest).concat();
            if folded.is_empty() {
                return Some((right, restored));
            }
            for group in groups.iter().filter(|group| folded.iter().any(|point| group.contains(point))) {
                group.iter().for_each(|point| moved[*point as usize] = points[*point as usize]);
            }
        }
        None
    }

    /// Triangles of the finest level, the thinnest first: no order that depends on numbers.
    fn thin_triangles(&self, surface: &LevelPoints<'_>) -> Vec<u32> {
        let bound = sine(1.0).powi(2);
        let elements = surface.elements();
        let labelled = self.network.level_from_before(self.finest()).labels().len();
        let of_labelled = |labelled: u32| {
            let mut thin = Vec::new();
            let mut place = 0;
            surface.for_each_in(labelled, |corners| {
                if let [a, b, c] = *corners {
                    let squared_sine = squared_sine([a, b, c]);
                    if squared_sine < bound {
                        thin.push((squared_sine, elements.element_in(labelled, place)));
                    }
                }
                place += 1;
            });
            thin
        };
        let mut thin: Vec<(f64, u32)> =
            (0..id(labelled)).into_par_iter().flat_map_iter(of_labelled).collect();
        thin.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        thin.into_iter().map(|(_, triangle)| triangle).collect()
    }

    /// What can move for some triangles of the finest level, boundary by boundary. What is a copy follows its original, and lines that
    /// have copies stay.
    fn movable_points(&self, thin: &[u32], moving: Moving) -> Vec<Vec<u32>> {
        let level = &self.network.levels()[self.level];
        let Mesh::Triangles(mesh) = &level.mesh else { return Vec::new() };
        let copies = || level.copies.vertices.iter();
        let originals: HashSet<u32> = copies().map(|pair| pair.primary).collect();
        let secondaries: HashSet<u32> = copies().map(|pair| pair.secondary).collect();
        let mut groups: Vec<Vec<u32>> = Vec::new();
        let mut group_of: HashMap<BoundaryId, usize> = HashMap::new();
        for triangle in thin {
            let boundary = self.network.finest().boundary(*triangle);
            let group = *group_of.entry(boundary).or_insert_with(|| {
                let own = self.patches.patch(boundary.index()).control_points.iter();
                let inside = own.filter(|point| mesh.vertex_rule(**point) == VertexRule::Smooth);
                groups.push(inside.copied().collect());
                groups.len() - 1
            });
            if moving == Moving::Lines {
                let dependencies = self.dependencies(self.finest(), *triangle).into_iter();
                groups[group].extend(dependencies.filter(|point| {
                    mesh.vertex_rule(*point) == VertexRule::Crease && !originals.contains(point)
                }));
            }
        }
        for group in &mut groups {
            group.retain(|point| !secondaries.contains(point));
            group.sort_unstable();
            group.dedup();
        }
        groups.retain(|group| !group.is_empty());
        groups
    }

    /// Moves groups of points so that the triangles around are wide; tells whether that was any help. The budget counts the triangles of the level that
    /// may be looked at.
    fn widen(&self, points: &mut [DVec3], movable: &[Vec<u32>], budget: &mut f64) -> bool {
        let level = &self.network.levels()[self.level];
        let elements = BoundaryElements::of_level(level, self.network.boundaries().len());
        let boundaries_around = |movable: &Vec<u32>| {
            let places = movable.iter().flat_map(|point| self.patches.places_of_point(*point));
            let mut boundaries: Vec<usize> =
                places.map(|place| self.patches.patch_of_place(*place)).collect();
            boundaries.sort_unstable();
            boundaries.dedup();
            boundaries
        };
        // Groups with boundaries in common, which share lines, take turns.
        let mut turns: Vec<Vec<(&Vec<u32>, Vec<u32>)>> = Vec::new();
        let mut next_turn = vec![0; elements.boundary_count()];
        let mut work = 0;
        for movable in movable {
            let boundaries = boundaries_around(movable);
            let turn = boundaries.iter().map(|boundary| next_turn[*boundary]).max().unwrap_or(0);
            boundaries.iter().for_each(|boundary| next_turn[*boundary] = turn + 1);
            let around: Vec<u32> = boundaries.iter().flat_map(|boundary| elements.of(*boundary)).collect();
            work += around.len();
            turns.resize_with(turns.len().max(turn + 1), Vec::new);
            turns[turn].push((movable, around));
        }
        let work = work as f64;
        let most_steps = (0..=STEPS).take_while(|steps| *steps as f64 * work <= *budget).last().unwrap_or(0);
        if most_steps == 0 {
            return false;
        }
        let mut is_wider = false;
        for groups in turns {
            let widened = |(movable, around): (&Vec<u32>, Vec<u32>)| {
                check_cancelled();
                let size = around.len();
                let room = Room::new(self.network, self.level, around, movable, points)?;
                Some((size, room.widened(sine(WIDE), most_steps)))
            };
            let widened: Vec<(usize, Widened)> = groups.into_par_iter().filter_map(widened).collect();
            for (size, widened) in widened {
                *budget -= (widened.steps * size) as f64;
                is_wider |= !widened.points.is_empty();
                for (point, place) in widened.points {
                    points[point as usize] = place;
                }
            }
        }
        level.copies.place(self.network.domain(), points);
        is_wider
    }
}

/// The sine of an angle in units of the bound.
fn sine(angle: f64) -> f64 {
    (angle * TriangleQuality::BOUND).to_radians().sin()
}
