//! Which grains triangles enclose that say nothing of them.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use glam::DVec3;

use crate::maps::sets::Sets;

/// The labels behind and in front of each triangle: grains in the order in which triangles first touch them, from 0, and the exterior as -1.
///
/// Around each edge, what lies between a triangle and the next has one label. What hangs together so is a shell: that of a grain, or, seen from beyond, of a cluster of grains,
/// which the exterior surrounds or another grain.
///
/// # Errors
/// The middle of an edge that a single triangle has.
pub(super) fn enclosed(points: &[DVec3], triangles: &[[u32; 3]]) -> Result<Vec<[i64; 2]>, DVec3> {
    let mut shells = joined(points, triangles)?;
    let shell_of: Vec<usize> = (0..2 * triangles.len()).map(|side| shells.first(side)).collect();
    let mut volumes: BTreeMap<usize, f64> = BTreeMap::new();
    let origin = points.first().copied().unwrap_or(DVec3::ZERO);
    for (side, shell) in shell_of.iter().enumerate() {
        let [a, b, c] = triangles[side / 2].map(|corner| points[corner as usize] - origin);
        let volume = a.dot(b.cross(c)) / 6.0;
        // Normals point away from what lies behind.
        *volumes.entry(*shell).or_default() += if side % 2 == 0 { volume } else { -volume };
    }
    let mut clusters = Sets::new(points.len());
    for [a, b, c] in triangles {
        clusters.join(*a as usize, *b as usize);
        clusters.join(*b as usize, *c as usize);
    }
    let cluster_of: BTreeMap<usize, usize> =
        volumes.keys().map(|shell| (*shell, clusters.first(triangles[shell / 2][0] as usize))).collect();
    let grains: Vec<usize> =
        volumes.iter().filter(|(_, volume)| **volume > 0.0).map(|(shell, _)| *shell).collect();
    let mut label_of: BTreeMap<usize, i64> = grains.iter().copied().zip(0..).collect();
    for shell in volumes.keys().filter(|shell| !grains.contains(shell)) {
        let own = cluster_of[shell];
        let place = points[triangles[shell / 2][0] as usize];
        let mut turns: BTreeMap<usize, f64> = BTreeMap::new();
        for (side, shell) in shell_of.iter().enumerate().filter(|(_, shell)| label_of.contains_key(shell)) {
            let angle = solid_angle(triangles[side / 2].map(|corner| points[corner as usize] - place));
            *turns.entry(*shell).or_default() += if side % 2 == 0 { angle } else { -angle };
        }
        // A point is inside or outside: 4 pi or 0.
        let is_around = |grain: &&usize| turns[grain] > TAU && cluster_of[*grain] != own;
        let smallest = grains.iter().filter(is_around).min_by(|a, b| volumes[*a].total_cmp(&volumes[*b]));
        label_of.insert(*shell, smallest.map_or(-1, |grain| label_of[grain]));
    }
    Ok(shell_of.as_chunks::<2>().0.iter().map(|sides| sides.map(|shell| label_of[&shell])).collect())
}

/// The sides of triangles, two for each, the one behind first: joined where nothing lies between.
fn joined(points: &[DVec3], triangles: &[[u32; 3]]) -> Result<Sets, DVec3> {
    // The triangles around each edge, whether they run along it from the smaller point, and their third corners.
    let mut around: BTreeMap<[u32; 2], Vec<(usize, bool, u32)>> = BTreeMap::new();
    for (index, &[a, b, c]) in triangles.iter().enumerate() {
        for [from, to, third] in [[a, b, c], [b, c, a], [c, a, b]] {
            around.entry([from.min(to), from.max(to)]).or_default().push((index, from < to, third));
        }
    }
    let mut sides = Sets::new(2 * triangles.len());
    for (ends, around) in around {
        let [from, to] = ends.map(|end| points[end as usize]);
        if around.len() < 2 {
            return Err(from.midpoint(to));
        }
        let axis = (to - from).normalize_or(DVec3::X);
        let u = axis.any_orthonormal_vector();
        let v = axis.cross(u);
        let angle = |third: u32| {
            let radius = points[third as usize] - from;
            radius.dot(v).atan2(radius.dot(u))
        };
        let mut in_order: Vec<(f64, usize, bool)> =
            around.into_iter().map(|(index, is_along, third)| (angle(third), index, is_along)).collect();
        in_order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let next = in_order.iter().cycle().skip(1);
        for ((_, index, is_along), (_, next, next_is_along)) in in_order.iter().zip(next) {
            // The normal of a triangle that runs along the axis points to where angles grow.
            sides.join(2 * index + usize::from(*is_along), 2 * next + usize::from(!next_is_along));
        }
    }
    Ok(sides)
}

/// The signed solid angle of a triangle, seen from the origin (Van Oosterom and Strackee 1983).
fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let [x, y, z] = [a, b, c].map(DVec3::length);
    let below = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
    2.0 * a.dot(b.cross(c)).atan2(below)
}
