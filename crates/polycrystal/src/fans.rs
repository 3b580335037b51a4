//! Points where the surface of a grain touches itself, with no edge in common.

use crate::fault::Fault;
use crate::seams::Seams;
use crate::{Elements, Side, Surface};

/// The points of closed surfaces in space where the triangles of a grain are not one fan around the point but several.
///
/// In the plane, where places are points, that is what closing tells.
pub(crate) fn pinched_points(surface: &Surface<'_>, seams: &Seams) -> Vec<Fault> {
    let Elements::Triangles(triangles) = surface.elements else { return Vec::new() };
    let fans = Fans::within_boundaries(triangles, &seams.inner);
    // Where there is one fan in all, it is that of both sides.
    let several = fans.points_of_several(triangles, surface.points.len());
    if !several.contains(&true) {
        return Vec::new();
    }
    let mut parts: Vec<Part> = Vec::new();
    for (corner, point) in (0u32..).zip(triangles.as_flattened()) {
        if several[*point as usize] {
            let fan = fans.root(corner);
            parts.extend(surface.sides_of(corner / 3).map(|side| Part { point: *point, side, fan }));
        }
    }
    parts.sort_unstable();
    parts.dedup();
    let mut joined = Joined { parents: (0u32..).take(parts.len()).collect() };
    let place = |part: Part| u32::try_from(parts.binary_search(&part).ok()?).ok();
    for at in seams.places() {
        let mut uses: Vec<(Side, u32, u32)> = Vec::with_capacity(2 * at.len());
        for at in at {
            let corner = u32::from(at.corner);
            let corners = [3 * at.element + corner, 3 * at.element + (corner + 1) % 3];
            uses.extend(surface.sides_of(at.element).into_iter().flat_map(|side| {
                corners.map(|corner| (side, triangles.as_flattened()[corner as usize], fans.root(corner)))
            }));
        }
        uses.sort_unstable();
        for pair in uses.windows(2).filter(|pair| (pair[0].0, pair[0].1) == (pair[1].0, pair[1].1)) {
            let [a, b] = [0, 1].map(|k| place(Part { point: pair[k].1, side: pair[k].0, fan: pair[k].2 }));
            if let (Some(a), Some(b)) = (a, b) {
                joined.join(a, b);
            }
        }
    }
    let mut faults = Vec::new();
    let mut first = 0u32;
    for group in parts.chunk_by(|a, b| (a.point, a.side) == (b.point, b.side)) {
        let members = (first..).take(group.len());
        let fans = members.filter(|part| joined.root(*part) == *part).count();
        first += u32::try_from(group.len()).expect("ids fit 32 bits");
        if let (Side::Grain(grain), 2..) = (group[0].side, fans) {
            faults.push(Fault::PinchedPoint { point: group[0].point, grain, fans });
        }
    }
    faults
}

/// A fan of triangles of one boundary around a point, as one of its sides has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Part {
    point: u32,
    side: Side,
    fan: u32,
}

/// The corners of all triangles, joined where triangles of one boundary share an edge.
struct Fans(Joined);

impl Fans {
    fn within_boundaries(triangles: &[[u32; 3]], inner: &[[u32; 2]]) -> Self {
        let mut corners = Joined { parents: (0u32..).take(3 * triangles.len()).collect() };
        for pair in inner {
            let [one, other] = pair.map(|triangle| triangles[triangle as usize]);
            for (k, point) in (0u32..).zip(one) {
                if let Some(place) = other.iter().position(|corner| *corner == point) {
                    let place = u32::try_from(place).expect("one of three");
                    corners.join(3 * pair[0] + k, 3 * pair[1] + place);
                }
            }
        }
        Self(corners)
    }

    /// The number of the fan that a corner belongs to.
    fn root(&self, corner: u32) -> u32 {
        self.0.root(corner)
    }

    /// Whether the corners at each point are of several fans.
    fn points_of_several(&self, triangles: &[[u32; 3]], point_count: usize) -> Vec<bool> {
        const NONE: u32 = u32::MAX;
        let mut first = vec![NONE; point_count];
        let mut several = vec![false; point_count];
        for (corner, point) in (0u32..).zip(triangles.as_flattened()) {
            let root = self.root(corner);
            let known = &mut first[*point as usize];
            several[*point as usize] |= *known != NONE && *known != root;
            *known = root;
        }
        several
    }
}

/// Disjoint sets, each named by its lowest member.
struct Joined {
    parents: Vec<u32>,
}

impl Joined {
    fn root(&self, mut member: u32) -> u32 {
        while self.parents[member as usize] != member {
            member = self.parents[member as usize];
        }
        member
    }

    fn join(&mut self, a: u32, b: u32) {
        let [a, b] = [a, b].map(|member| self.root_halving(member));
        self.parents[a.max(b) as usize] = a.min(b);
    }

    fn root_halving(&mut self, mut member: u32) -> u32 {
        while self.parents[member as usize] != member {
            let grandparent = self.parents[self.parents[member as usize] as usize];
            self.parents[member as usize] = grandparent;
            member = grandparent;
        }
        member
    }
}
