//! The triangles of a boundary while they change.

use glam::DVec3;

use crate::mesh::id::id;

/// The triangles of one boundary, and what they may do: edges are halved, collapse, and flip. Points of its outline stay as they are.
#[derive(Debug, Default)]
pub(crate) struct Patch {
    pub(crate) points: Vec<DVec3>,
    /// Of each point of the outline the lines that it lies on; none inside the boundary.
    pub(crate) lines: Vec<Vec<u32>>,
    /// Nothing for one that has gone.
    triangles: Vec<Option<[u32; 3]>>,
    /// The triangles at each point.
    stars: Vec<Vec<u32>>,
}

impl Patch {
    pub(crate) fn new(points: Vec<DVec3>, lines: Vec<Vec<u32>>, triangles: &[[u32; 3]]) -> Self {
        let stars = vec![Vec::new(); points.len()];
        let mut patch = Self { points, lines, triangles: Vec::new(), stars };
        triangles.iter().for_each(|corners| patch.add(*corners));
        patch
    }

    fn add(&mut self, corners: [u32; 3]) {
        let triangle = id(self.triangles.len());
        self.triangles.push(Some(corners));
        corners.iter().for_each(|corner| self.stars[*corner as usize].push(triangle));
    }

    fn remove(&mut self, triangle: u32) {
        for corner in self.triangles[triangle as usize].take().into_iter().flatten() {
            self.stars[corner as usize].retain(|other| *other != triangle);
        }
    }

    /// The corners of a triangle.
    ///
    /// # Panics
    /// When it has gone.
    pub(crate) fn corners(&self, triangle: u32) -> [u32; 3] {
        self.triangles[triangle as usize].expect("stars hold triangles that are there")
    }

    /// All triangles.
    pub(crate) fn all(&self) -> impl Iterator<Item = [u32; 3]> {
        self.triangles.iter().flatten().copied()
    }

    pub(crate) fn is_outline(&self, point: u32) -> bool {
        !self.lines[point as usize].is_empty()
    }

    /// The triangles at a point; none where it has gone.
    pub(crate) fn star(&self, point: u32) -> &[u32] {
        &self.stars[point as usize]
    }

    /// Whether a point is inside the boundary and still there.
    pub(crate) fn is_inside(&self, point: u32) -> bool {
        !self.is_outline(point) && !self.star(point).is_empty()
    }

    pub(crate) fn place(&self, point: u32) -> DVec3 {
        self.points[point as usize]
    }

    pub(crate) fn places(&self, corners: [u32; 3]) -> [DVec3; 3] {
        corners.map(|corner| self.place(corner))
    }

    pub(crate) fn length(&self, [from, to]: [u32; 2]) -> f64 {
        self.place(from).distance(self.place(to))
    }

    /// The points that share an edge with one, in order.
    pub(crate) fn neighbours(&self, point: u32) -> Vec<u32> {
        let corners = self.star(point).iter().flat_map(|triangle| self.corners(*triangle));
        let mut neighbours: Vec<u32> = corners.filter(|corner| *corner != point).collect();
        neighbours.sort_unstable();
        neighbours.dedup();
        neighbours
    }

    /// The edges inside the boundary, the lower end first, in order.
    pub(crate) fn inner_edges(&self) -> Vec<[u32; 2]> {
        let edges = self.all().flat_map(edges);
        let mut edges: Vec<[u32; 2]> = edges.map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        edges.chunk_by(|a, b| a == b).filter(|same| same.len() == 2).map(|same| same[0]).collect()
    }

    /// The triangles at an edge.
    pub(crate) fn at_edge(&self, [from, to]: [u32; 2]) -> Vec<u32> {
        let has_both = |triangle: &&u32| self.corners(**triangle).contains(&to);
        self.star(from).iter().filter(has_both).copied().collect()
    }

    pub(crate) fn is_edge(&self, [from, to]: [u32; 2]) -> bool {
        self.star(from).iter().any(|triangle| self.corners(*triangle).contains(&to))
    }

    /// Whether an edge may come to be between two points: none that joins two points of one line, which other boundaries at that line
    /// could have too.
    pub(crate) fn may_join(&self, [from, to]: [u32; 2]) -> bool {
        let lines = &self.lines[to as usize];
        !self.lines[from as usize].iter().any(|line| lines.contains(line))
    }

    /// Halves an edge at a new point, whose number this returns. A point of the outline comes with its lines.
    pub(crate) fn split(&mut self, ends: [u32; 2], place: DVec3, lines: Vec<u32>) -> u32 {
        let middle = id(self.points.len());
        self.points.push(place);
        self.lines.push(lines);
        self.stars.push(Vec::new());
        for triangle in self.at_edge(ends) {
            let corners = self.corners(triangle);
            self.remove(triangle);
            for end in ends {
                self.add(corners.map(|corner| if corner == end { middle } else { corner }));
            }
        }
        middle
    }

    /// Puts a new point into a triangle, and returns its number.
    pub(crate) fn split_triangle(&mut self, triangle: u32, place: DVec3) -> u32 {
        let middle = id(self.points.len());
        self.points.push(place);
        self.lines.push(Vec::new());
        self.stars.push(Vec::new());
        let [a, b, c] = self.corners(triangle);
        self.remove(triangle);
        [[a, b, middle], [b, c, middle], [c, a, middle]].into_iter().for_each(|corners| self.add(corners));
        middle
    }

    /// The points that both ends of an edge share edges with, but no triangle: nothing may be between them when the edge collapses.
    pub(crate) fn pinched(&self, [from, to]: [u32; 2]) -> Vec<u32> {
        let across: Vec<u32> =
            self.at_edge([from, to]).into_iter().flat_map(|triangle| self.corners(triangle)).collect();
        let theirs = self.neighbours(to);
        let mut pinched = self.neighbours(from);
        pinched.retain(|point| theirs.binary_search(point).is_ok() && !across.contains(point));
        pinched
    }

    /// The triangles at an edge's first end that stay when it collapses, with the corners that they then have.
    pub(crate) fn after_collapse(&self, [from, to]: [u32; 2]) -> Vec<[u32; 3]> {
        let all = self.star(from).iter().map(|triangle| self.corners(*triangle));
        let stay = all.filter(|corners| !corners.contains(&to));
        stay.map(|corners| corners.map(|corner| if corner == from { to } else { corner })).collect()
    }

    /// Moves the first end of an edge into the other.
    pub(crate) fn collapse(&mut self, ends: [u32; 2]) {
        let new = self.after_collapse(ends);
        for triangle in self.star(ends[0]).to_vec() {
            self.remove(triangle);
        }
        new.into_iter().for_each(|corners| self.add(corners));
    }

    /// The two triangles that take the place of those at an inner edge when it flips; nothing where the new edge is there already.
    pub(crate) fn after_flipping(&self, ends: [u32; 2]) -> Option<[[u32; 3]; 2]> {
        let [first, second] = self.at_edge(ends)[..] else { return None };
        let corners = self.corners(first);
        let start = corners.iter().position(|corner| !ends.contains(corner))?;
        let [top, from, to] = [0, 1, 2].map(|step| corners[(start + step) % 3]);
        let bottom = self.corners(second).into_iter().find(|corner| !ends.contains(corner))?;
        let is_free = top != bottom && !self.is_edge([top, bottom]);
        is_free.then_some([[top, from, bottom], [top, bottom, to]])
    }

    /// Flips an inner edge.
    pub(crate) fn flip(&mut self, ends: [u32; 2], new: [[u32; 3]; 2]) {
        for triangle in self.at_edge(ends) {
            self.remove(triangle);
        }
        new.into_iter().for_each(|corners| self.add(corners));
    }
}

/// The edges of a triangle, as they run around it.
pub(crate) fn edges([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// The least angle of a triangle, as a cosine that grows as the angle does: minus the cosine of it, from -1 to -1/2. -1 where two corners are one.
pub(crate) fn least_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let sides = [b - a, c - b, a - c];
    let cosine = |k: usize| {
        let (one, other) = (sides[k], -sides[(k + 2) % 3]);
        one.dot(other) / (one.length() * other.length())
    };
    let largest = cosine(0).max(cosine(1)).max(cosine(2));
    if largest.is_nan() { -1.0 } else { -largest }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of four triangles around its middle.
    fn square() -> Patch {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]];
        let points = corners.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
        let lines = vec![vec![0, 3], vec![0, 1], vec![1, 2], vec![2, 3], vec![]];
        Patch::new(points, lines, &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    }

    #[test]
    fn edges_are_halved_and_close_again() {
        let mut patch = square();
        let middle = patch.split([0, 4], DVec3::new(0.25, 0.25, 0.0), Vec::new());
        assert_eq!(patch.all().count(), 6);
        assert_eq!(patch.neighbours(middle), [0, 1, 3, 4]);
        patch.collapse([middle, 4]);
        assert_eq!(patch.all().count(), 4);
        assert_eq!(patch.neighbours(4), [0, 1, 2, 3]);
        assert_eq!(patch.inner_edges(), [[0, 4], [1, 4], [2, 4], [3, 4]]);
    }

    #[test]
    fn a_flip_joins_what_was_across() {
        let mut patch = square();
        assert!(!patch.may_join([0, 1]) && patch.may_join([0, 2]));
        let new = patch.after_flipping([0, 4]).expect("two triangles");
        patch.flip([0, 4], new);
        assert!(patch.is_edge([1, 3]) && !patch.is_edge([0, 4]));
        // Collapsing the new edge would leave nothing of the triangles at 2 but one on the other.
        assert_eq!(patch.pinched([1, 3]), [2]);
    }

    #[test]
    fn the_least_angle_grows_with_its_measure() {
        let narrow = least_angle([DVec3::ZERO, DVec3::X, DVec3::new(1.0, 0.1, 0.0)]);
        let regular = least_angle([DVec3::ZERO, DVec3::X, DVec3::new(0.5, 0.75f64.sqrt(), 0.0)]);
        assert!(narrow < regular && (regular + 0.5).abs() < 1e-12);
        assert_eq!(least_angle([DVec3::ZERO, DVec3::ZERO, DVec3::X]), -1.0);
    }
}
