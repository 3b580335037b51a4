//! The parts of a network's surface, each with the grains on its two sides: which of them hang together, and which edges are no boundaries.

use glam::DVec3;

/// Outer faces of one grain that differ by less are facets of a curved domain, as a cosine: those of a sphere differ by 10 degrees, of a
/// cylinder by 14, of an icosahedron by 42.
const FACET_COSINE: f64 = 0.94;

/// Triangles with grains on both sides.
pub(crate) struct Parts<'a, T> {
    pub(crate) points: &'a [DVec3],
    /// Of each part, the grain that normals point from and the one that they point to.
    pub(crate) sides: &'a [[Option<u32>; 2]],
    /// The triangles of a part.
    pub(crate) triangles_of: T,
}

/// What hangs together of a grain, which the box may have cut.
pub(crate) struct Pieces {
    /// Of each side of each part, the piece.
    pub(crate) of_sides: Vec<[Option<usize>; 2]>,
    /// Of each piece, the mean of its surface.
    pub(crate) centers: Vec<DVec3>,
}

/// A side of a triangle of the outer surface.
struct OuterSide {
    /// The grain and the ends.
    edge: (u32, [u32; 2]),
    part: usize,
    /// Of the triangle.
    normal: DVec3,
}

impl<T: Fn(usize) -> I, I: Iterator<Item = [u32; 3]>> Parts<'_, T> {
    /// The pieces of all grains: parts of a grain that have a point in common are of one.
    pub(crate) fn pieces(&self) -> Pieces {
        let mut parts_of: Vec<(u32, usize, usize)> = Vec::new();
        for (part, sides) in self.sides.iter().enumerate() {
            for (side, grain) in sides.iter().enumerate() {
                parts_of.extend(grain.map(|grain| (grain, part, side)));
            }
        }
        parts_of.sort_unstable();
        let mut pieces = Pieces { of_sides: vec![[None; 2]; self.sides.len()], centers: Vec::new() };
        let mut seen_by = vec![(usize::MAX, 0); self.points.len()];
        for (number, members) in parts_of.chunk_by(|a, b| a.0 == b.0).enumerate() {
            // Each part leads to an earlier one with which it hangs together, or to itself.
            let mut leader: Vec<usize> = (0..members.len()).collect();
            let root = |leader: &[usize], mut member: usize| {
                while leader[member] != member {
                    member = leader[member];
                }
                member
            };
            for (member, (_, part, _)) in members.iter().enumerate() {
                for point in (self.triangles_of)(*part).flatten() {
                    let seen = &mut seen_by[point as usize];
                    if seen.0 == number {
                        let [a, b] = [root(&leader, member), root(&leader, seen.1)];
                        leader[a.max(b)] = a.min(b);
                    } else {
                        *seen = (number, member);
                    }
                }
            }
            let mut piece_of = vec![0; members.len()];
            let mut sums: Vec<(f64, DVec3)> = Vec::new();
            for (member, (_, part, side)) in members.iter().enumerate() {
                let first = root(&leader, member);
                if first == member {
                    piece_of[member] = sums.len();
                    sums.push((0.0, DVec3::ZERO));
                }
                let piece = piece_of[first];
                pieces.of_sides[*part][*side] = Some(pieces.centers.len() + piece);
                for [a, b, c] in
                    (self.triangles_of)(*part).map(|corners| corners.map(|id| self.points[id as usize]))
                {
                    let area = (b - a).cross(c - a).length();
                    sums[piece].0 += area;
                    sums[piece].1 += area * (a + b + c) / 3.0;
                }
            }
            pieces.centers.extend(sums.into_iter().map(|(area, sum)| sum / area.max(f64::MIN_POSITIVE)));
        }
        pieces
    }

    /// The edges of a grain's outer surface between facets of a curved domain, with the grain; in order.
    pub(crate) fn facet_edges(&self) -> Vec<(u32, [u32; 2])> {
        let mut edges: Vec<OuterSide> = Vec::new();
        for (part, sides) in self.sides.iter().enumerate() {
            let &[Some(grain), None] = sides else { continue };
            for triangle in (self.triangles_of)(part) {
                let [a, b, c] = triangle.map(|id| self.points[id as usize]);
                let normal = (b - a).cross(c - a).normalize_or_zero();
                let [a, b, c] = triangle;
                let sides = [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]);
                edges.extend(sides.map(|ends| OuterSide { edge: (grain, ends), part, normal }));
            }
        }
        edges.sort_unstable_by_key(|side| (side.edge, side.part));
        let between = |sides: &&[OuterSide]| match sides {
            [one, other] => one.part != other.part && one.normal.dot(other.normal) > FACET_COSINE,
            _ => false,
        };
        edges.chunk_by(|a, b| a.edge == b.edge).filter(between).map(|sides| sides[0].edge).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two tetrahedra of one grain, far from each other, each in two parts.
    #[test]
    fn pieces_hang_together() {
        let corner =
            |at: f64| [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|point| point + DVec3::splat(at));
        let points = [corner(0.0), corner(5.0)].concat();
        let triangles =
            |first: u32| [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(|one| one.map(|id| first + id));
        let [near, far] = [triangles(0), triangles(4)];
        let of_part = [&near[..3], &far[..3], &near[3..], &far[3..]];
        let sides = [[Some(7), None]; 4];
        let parts = Parts {
            points: &points,
            sides: &sides,
            triangles_of: |part: usize| of_part[part].iter().copied(),
        };
        let Pieces { of_sides, centers } = parts.pieces();
        assert_eq!(of_sides, [0, 1, 0, 1].map(|piece| [Some(piece), None]));
        assert!((centers[1] - centers[0] - DVec3::splat(5.0)).length() < 1e-12, "{centers:?}");
        assert_eq!(parts.facet_edges(), [], "corners are no facets");
    }

    #[test]
    fn edges_between_facets_are_no_boundaries() {
        for (height, wanted) in [(0.05, 1), (0.5, 0)] {
            let points =
                [DVec3::ZERO, DVec3::Y, DVec3::new(1.0, 0.5, -height), DVec3::new(-1.0, 0.5, -height)];
            let of_part = [[[0, 2, 1]], [[0, 1, 3]]];
            let sides = [[Some(0), None]; 2];
            let parts = Parts {
                points: &points,
                sides: &sides,
                triangles_of: |part: usize| of_part[part].into_iter(),
            };
            assert_eq!(parts.facet_edges().len(), wanted);
        }
    }
}
