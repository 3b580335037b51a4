use glam::DVec3;
use voronoi::{Domain, Tessellation, Wall};

use crate::Boundary;
use crate::mesh::id::id;

/// Sine of the angle between two walls, or a wall and a line, below which they count as parallel: they hold a point in the
/// same way.
pub(crate) const PARALLEL: f64 = 1e-9;

/// The walls of the domain that a point lies on: those of a face, an edge or a corner of it, numbered by [`WallSets`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct WallSet(u32);

impl WallSet {
    /// No wall: a point inside the domain.
    pub const EMPTY: Self = Self(0);

    /// Whether the point lies on no wall.
    pub fn is_empty(self) -> bool {
        self == Self::EMPTY
    }
}

/// All sets of walls that points of a network lie on.
#[derive(Debug, Clone, PartialEq)]
pub struct WallSets {
    /// Sorted sets of sorted walls; the first is empty.
    sets: Vec<Vec<Wall>>,
    freedoms: Vec<Freedom>,
    /// Of each set, the coordinates that its walls prescribe.
    coordinates: Vec<Vec<(usize, f64)>>,
}

impl WallSets {
    /// The same walls of a box, with each coordinate multiplied by a factor of its axis.
    pub(crate) fn stretched(mut self, factors: DVec3) -> Self {
        let coordinates = self.coordinates.iter_mut().flatten();
        coordinates.for_each(|(axis, coordinate)| *coordinate *= factors[*axis]);
        self
    }

    /// The sets of a tessellation, and that of each of its vertices. They are those of its walls, its vertices, and the edges
    /// between these: as the domain is convex, what two of them have in common is again one of them.
    pub(crate) fn new(
        tessellation: &Tessellation,
        boundaries: &[Boundary],
        edges: impl Iterator<Item = [usize; 2]>,
    ) -> (Self, Vec<WallSet>) {
        let mut of_vertices: Vec<Vec<Wall>> = vec![Vec::new(); tessellation.vertices().len()];
        for (face, boundary) in tessellation.faces().zip(boundaries) {
            let Some(wall) = boundary.wall else { continue };
            for corner in tessellation.face_corners(face) {
                let walls = &mut of_vertices[corner.index()];
                if let Err(place) = walls.binary_search(&wall) {
                    walls.insert(place, wall);
                }
            }
        }
        let ends = edges.map(|ends| ends.map(id));
        Self::of_walls(tessellation.domain(), &of_vertices, boundaries, ends)
    }

    /// The sets of points on the walls of a domain, and those between points that an edge joins.
    pub(crate) fn of_walls(
        domain: &Domain,
        of_vertices: &[Vec<Wall>],
        boundaries: &[Boundary],
        edges: impl Iterator<Item = [u32; 2]>,
    ) -> (Self, Vec<WallSet>) {
        let mut sets = vec![Vec::new()];
        sets.extend(boundaries.iter().filter_map(|boundary| Some(vec![boundary.wall?])));
        let of_edges = edges.map(|[a, b]| common(&of_vertices[a as usize], &of_vertices[b as usize]));
        sets.extend(of_edges.filter(|walls| walls.len() > 1));
        sets.extend(of_vertices.iter().filter(|walls| walls.len() > 1).cloned());
        sets.sort_unstable();
        sets.dedup();
        let freedom = |walls: &Vec<Wall>| {
            let held = walls.iter().map(|wall| Freedom::InPlane(domain.outward_normal(*wall)));
            held.fold(Freedom::Everywhere, Freedom::and)
        };
        let coordinates =
            |walls: &Vec<Wall>| walls.iter().filter_map(|wall| domain.across_axis(*wall)).collect();
        let all = Self {
            freedoms: sets.iter().map(freedom).collect(),
            coordinates: sets.iter().map(coordinates).collect(),
            sets,
        };
        let numbers = of_vertices.iter().map(|walls| all.find(walls)).collect();
        (all, numbers)
    }

    /// The set of one wall alone.
    pub(crate) fn only(&self, wall: Option<Wall>) -> WallSet {
        wall.map_or(WallSet::EMPTY, |wall| self.find(&[wall]))
    }

    fn find(&self, walls: &[Wall]) -> WallSet {
        let place = self.sets.binary_search_by(|set| set.as_slice().cmp(walls));
        let place = place.expect("faces of a convex domain have faces of it in common");
        WallSet(u32::try_from(place).expect("no more sets than walls and vertices"))
    }

    /// The walls in a set, sorted.
    pub fn walls(&self, set: WallSet) -> &[Wall] {
        &self.sets[set.0 as usize]
    }

    /// The walls that both points lie on, and so does the middle of a line between them.
    pub fn intersection(&self, a: WallSet, b: WallSet) -> WallSet {
        if a == b || a.is_empty() {
            return a;
        }
        if b.is_empty() { b } else { self.find(&common(self.walls(a), self.walls(b))) }
    }

    /// How a point can move without leaving its walls.
    pub fn freedom(&self, set: WallSet) -> Freedom {
        self.freedoms[set.0 as usize]
    }

    /// The point with its coordinates across walls that are perpendicular to axes set to the walls' own, which averaging may
    /// miss by a last place.
    pub fn put_on_walls(&self, set: WallSet, mut point: DVec3) -> DVec3 {
        for (axis, coordinate) in &self.coordinates[set.0 as usize] {
            point[*axis] = *coordinate;
        }
        point
    }
}

/// The walls in two sorted lists.
fn common(a: &[Wall], b: &[Wall]) -> Vec<Wall> {
    a.iter().copied().filter(|wall| b.binary_search(wall).is_ok()).collect()
}

/// How a point can move.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Freedom {
    /// In all directions.
    #[default]
    Everywhere,
    /// Perpendicular to a unit vector.
    InPlane(DVec3),
    /// Along a unit vector, both ways.
    Along(DVec3),
    /// Not at all.
    Nowhere,
}

impl Freedom {
    /// What is left to points with two freedoms that move as one.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Everywhere, freedom) | (freedom, Self::Everywhere) => freedom,
            (Self::Nowhere, _) | (_, Self::Nowhere) => Self::Nowhere,
            (Self::InPlane(a), Self::InPlane(b)) => {
                let line = a.cross(b);
                if line.length() < PARALLEL { self } else { Self::Along(line.normalize()) }
            }
            (Self::InPlane(normal), Self::Along(line)) | (Self::Along(line), Self::InPlane(normal)) => {
                if normal.dot(line).abs() < PARALLEL {
                    Self::Along(line)
                } else {
                    Self::Nowhere
                }
            }
            (Self::Along(a), Self::Along(b)) => {
                if a.cross(b).length() < PARALLEL {
                    self
                } else {
                    Self::Nowhere
                }
            }
        }
    }

    /// The part of a motion that is free.
    pub fn project(self, motion: DVec3) -> DVec3 {
        match self {
            Self::Everywhere => motion,
            Self::InPlane(normal) => motion - normal * normal.dot(motion),
            Self::Along(line) => line * line.dot(motion),
            Self::Nowhere => DVec3::ZERO,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_take_freedom_one_by_one() {
        let plane = Freedom::InPlane(DVec3::X);
        let line = plane.and(Freedom::InPlane(DVec3::new(0.6, 0.8, 0.0)));
        let motion = DVec3::new(1.0, 2.0, 3.0);
        assert_eq!(plane.project(motion), DVec3::new(0.0, 2.0, 3.0));
        assert_eq!(line.project(motion), DVec3::new(0.0, 0.0, 3.0));
        assert_eq!(line.and(plane), line);
        assert_eq!(line.and(Freedom::InPlane(DVec3::NEG_X)), line);
        assert_eq!(line.and(Freedom::InPlane(DVec3::Z)), Freedom::Nowhere);
        assert_eq!(plane.and(Freedom::Everywhere).and(line), line);
        assert_eq!(Freedom::Along(DVec3::X).and(Freedom::Along(DVec3::NEG_X)), Freedom::Along(DVec3::X));
        assert_eq!(Freedom::Along(DVec3::X).and(Freedom::Along(DVec3::Y)).project(motion), DVec3::ZERO);
    }
}
