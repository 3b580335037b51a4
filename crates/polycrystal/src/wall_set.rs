use glam::{BVec3, DVec3};
use voronoi::{Domain, Wall};

/// The walls of the domain that a point lies on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WallSet(u8);

impl WallSet {
    /// No wall: a point inside the domain.
    pub const NONE: Self = Self(0);

    /// The set with one more wall.
    #[must_use]
    pub fn with(self, wall: Wall) -> Self {
        Self(self.0 | 1 << wall.index())
    }

    /// The walls that both points lie on, and so does the middle of a line between them.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// Whether the point lies on no wall.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Number of walls.
    pub fn len(self) -> u32 {
        self.0.count_ones()
    }

    /// The walls in the set.
    pub fn iter(self) -> impl Iterator<Item = Wall> {
        Wall::ALL.into_iter().filter(move |wall| self.0 & 1 << wall.index() != 0)
    }

    /// The axes along which the point can move without leaving a wall.
    pub fn free_axes(self) -> BVec3 {
        let locked = |axis: usize| self.0 >> (2 * axis) & 0b11 != 0;
        BVec3::new(!locked(0), !locked(1), !locked(2))
    }

    /// The point with its coordinates across the walls set to the walls' own, which averaging may miss by a last place.
    pub fn put_on_walls(self, domain: &Domain, mut point: DVec3) -> DVec3 {
        for wall in self.iter() {
            point[wall.axis()] = domain.wall_coordinate(wall);
        }
        point
    }
}
