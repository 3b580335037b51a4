//! Triangles of two boundaries that meet at an acute angle: the third corners of those on both sides of an edge face each other.
//!
//! All four points of the tetrahedron between two such triangles are on boundaries, so that nothing can make it better later. It is as flat as the
//! wedge in any case; where the third corners are apart, it is as flat as a sliver, even in the tip of a grain whose boundaries meet at more than 20 degrees.

use std::collections::BTreeMap;

use glam::DVec3;
use voronoi::{Domain, Translation};

use crate::mesh::tetrahedron::tetrahedron_gamma;
use crate::remesh::joints::Shaped;
use crate::remesh::shaping::Shaping;
use crate::remesh::torus::{Moved, seen_from_least};
use crate::remesh::tuning::RemeshTuning;

/// A triangle of a part at an edge of its outline.
#[derive(Debug, Clone, Copy)]
struct AtEdge {
    part: usize,
    /// The ends of the edge, in the same order for all parts.
    ends: [u32; 2],
    /// Its third corner.
    apex: u32,
    /// The periods that lead here from where the torus has the edge.
    translation: Translation,
}

impl AtEdge {
    fn place(&self, shaped: &[Shaped<'_>], point: u32) -> DVec3 {
        shaped[self.part].0.patch.place(point)
    }

    /// A place beside the edge of this one, as it is beside that of another.
    fn beside(&self, other: &Self, place: DVec3, domain: &Domain) -> DVec3 {
        place + (other.translation - self.translation).vector(domain)
    }

    /// The way from the edge to the third corner, across the edge.
    fn across(&self, shaped: &[Shaped<'_>]) -> DVec3 {
        let [from, to] = self.ends.map(|end| self.place(shaped, end));
        let way = self.place(shaped, self.apex) - from;
        way.reject_from(to - from)
    }
}

/// A point inside a boundary beside wedges.
struct Beside {
    part: usize,
    point: u32,
    /// The triangles that it is the third corner of, and those across from them.
    pairs: Vec<[AtEdge; 2]>,
    /// What the least angle around it stays above, as of [`least_angle`](crate::remesh::patch::least_angle).
    kept: f64,
}

/// Moves points inside boundaries to where tetrahedra in narrow wedges beside them are better. Where there is no such place, as a point has none to face, it goes into one that has.
pub(crate) fn face_across_wedges(shaped: &mut [Shaped<'_>], domain: &Domain, tuning: &RemeshTuning) {
    let mut wedges = beside_wedges(shaped, tuning);
    for _ in 0..tuning.searches {
        let [mut has_moved, mut has_collapsed] = [false; 2];
        for Beside { part, point, pairs, kept } in &wedges {
            let faces = faces_across(shaped, pairs, domain);
            let shaping = &mut shaped[*part].0;
            if !shaping.patch.is_inside(*point)
                || worst(&faces, shaping.patch.place(*point)) >= tuning.good_in_wedge
            {
                continue;
            }
            if face(shaping, *point, &faces, *kept) {
                has_moved = true;
            } else {
                has_collapsed |= give_way(shaping, *point, &faces, *kept);
            }
        }
        if has_collapsed {
            wedges = beside_wedges(shaped, tuning);
        } else if !has_moved {
            break;
        }
    }
}

fn beside_wedges(shaped: &[Shaped<'_>], tuning: &RemeshTuning) -> Vec<Beside> {
    let mut of_points: BTreeMap<(usize, u32), Vec<[AtEdge; 2]>> = BTreeMap::new();
    for at_edge in at_edges(shaped).values() {
        for (number, one) in at_edge.iter().enumerate() {
            for other in &at_edge[number + 1..] {
                if one.across(shaped).dot(other.across(shaped)) > 0.0 {
                    for pair in [[*one, *other], [*other, *one]] {
                        if shaped[pair[0].part].0.patch.is_inside(pair[0].apex) {
                            of_points.entry((pair[0].part, pair[0].apex)).or_default().push(pair);
                        }
                    }
                }
            }
        }
    }
    let beside = |((part, point), pairs): ((usize, u32), _)| {
        let shaping = &shaped[part].0;
        let least = (-shaping.worst_angle(&shaping.star(point))).acos();
        Beside { part, point, pairs, kept: -(tuning.kept_share * least).min(tuning.kept_angle).cos() }
    };
    of_points.into_iter().map(beside).collect()
}

/// The triangles across from those of a point, as seen from there.
fn faces_across(shaped: &[Shaped<'_>], wedges: &[[AtEdge; 2]], domain: &Domain) -> Vec<[DVec3; 3]> {
    let face = |[own, other]: &[AtEdge; 2]| {
        let [from, to] = own.ends.map(|end| own.place(shaped, end));
        [from, to, other.beside(own, other.place(shaped, other.apex), domain)]
    };
    wedges.iter().map(face).collect()
}

/// The worst gamma of the tetrahedra between some triangles and a point.
fn worst(faces: &[[DVec3; 3]], apex: DVec3) -> f64 {
    let gammas = faces.iter().map(|[a, b, c]| tetrahedron_gamma([*a, *b, *c, apex]).abs());
    gammas.fold(f64::INFINITY, f64::min)
}

/// Moves a point to a better place; whether there is one nearby.
fn face(shaping: &mut Shaping<'_>, point: u32, faces: &[[DVec3; 3]], kept: f64) -> bool {
    let star = shaping.star(point);
    shaping.search(point, &star, |shaping| {
        if shaping.worst_angle(&star) < kept { 0.0 } else { worst(faces, shaping.patch.place(point)) }
    })
}

/// Moves a point into a neighbour that faces triangles better; whether there is one.
fn give_way(shaping: &mut Shaping<'_>, point: u32, faces: &[[DVec3; 3]], kept: f64) -> bool {
    let before = worst(faces, shaping.patch.place(point));
    shaping.patch.neighbours(point).into_iter().any(|other| {
        shaping.collapse([point, other], |shaping, _, after| {
            shaping.worst_angle(after) >= kept && worst(faces, shaping.patch.place(other)) > before
        })
    })
}

/// The triangles at each edge of outlines, on the torus.
fn at_edges(shaped: &[Shaped<'_>]) -> BTreeMap<[Moved<u32>; 2], Vec<AtEdge>> {
    let mut all: BTreeMap<[Moved<u32>; 2], Vec<AtEdge>> = BTreeMap::new();
    for (part, (shaping, keys)) in shaped.iter().enumerate() {
        for corners in shaping.patch.all() {
            for turn in 0..3 {
                let [a, b, apex] = [0, 1, 2].map(|k| corners[(k + turn) % 3]);
                let (Some(of_a), Some(of_b)) = (keys.get(&a), keys.get(&b)) else { continue };
                if shaping.patch.at_edge([a, b]).len() == 1 {
                    let (key, translation) = seen_from_least([*of_a, *of_b]);
                    let ends = if of_a < of_b { [a, b] } else { [b, a] };
                    all.entry(key).or_default().push(AtEdge { part, ends, apex, translation });
                }
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::remesh::gradation::Gradation;
    use crate::remesh::patch::Patch;
    use crate::remesh::reference::Reference;

    /// Two squares that meet in an edge a period apart, one of them at a slope to the other, each of four triangles around a point inside.
    fn squares(tuning: &RemeshTuning, slope: f64, inside: [[f64; 2]; 2]) -> [Shaped<'_>; 2] {
        [0, 1].map(|number: u8| {
            let (slope, above) = if number == 0 { (0.0, 0.0) } else { (slope, 1.0) };
            let places = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], inside[usize::from(number)]];
            let lines = vec![vec![0, 3], vec![0, 1], vec![1, 2], vec![2, 3], vec![]];
            let triangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
            let points: Vec<DVec3> =
                places.iter().map(|[x, y]| DVec3::new(*x, *y, slope * y + above)).collect();
            let patch = Patch::new(points.clone(), lines, &triangles);
            let gradation = Gradation { growth: 0.4, most: 1.0 };
            let reference = Reference::new(points, vec![1.0; 5], triangles.to_vec(), gradation);
            let translation = Translation([0, 0, i8::try_from(number).expect("0 or 1")]);
            let originals = if number == 0 { [0, 1, 2, 3] } else { [0, 1, 4, 5] };
            let keys = (0u32..).zip(originals.map(|original| Moved { original, translation })).collect();
            (Shaping::new(patch, reference, &[0; 5], tuning), keys)
        })
    }

    /// At 27 degrees, third corners that were apart had stayed so: tetrahedra of a tip with lines at 20 degrees had a gamma of 0.016.
    #[test]
    fn points_on_both_sides_of_a_wedge_face_each_other() {
        let tuning = RemeshTuning::default();
        let domain = Domain::unit_cube().with_periods(glam::BVec3::TRUE);
        for (slope, inside) in [(0.176, [[0.3, 0.6], [0.65, 0.4]]), (0.5, [[0.15, 0.2], [0.85, 0.8]])] {
            let mut shaped = squares(&tuning, slope, inside);
            let gamma = |shaped: &[Shaped<'_>; 2]| {
                let [low, high] = [0, 1].map(|part| shaped[part].0.patch.place(4));
                tetrahedron_gamma([DVec3::ZERO, DVec3::X, low, high - DVec3::Z]).abs()
            };
            let before = gamma(&shaped);
            face_across_wedges(&mut shaped, &domain, &tuning);
            let after = gamma(&shaped);
            assert!(before < 0.2 && after > tuning.good_in_wedge, "{before} {after}");
            let place = shaped[1].0.patch.place(4);
            assert!((place.z - slope * place.y - 1.0).abs() < 1e-12, "it stays on its boundary");
        }
    }
}
