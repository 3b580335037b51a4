use crate::Wall;

/// What a cell's plane comes from: a site (the bisector with it) or a wall of the domain. Sites sort before walls.
///
/// Sites are the seeds, by number, then the periodic images of seeds. A wall across a periodic axis stands for the plane
/// half a period away from the cell's own seed; no finished cell has such a plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Generator(pub(crate) u32);

/// A generator, told apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Plane {
    Site(u32),
    Wall(Wall),
}

/// First code of a wall; the six walls take the last codes that 32 bits offer but one, which stays free.
const FIRST_WALL: u32 = u32::MAX - 7;

impl Generator {
    /// Number of sites that can be told from walls.
    pub(crate) const MAX_SITES: usize = FIRST_WALL as usize;

    /// No generator at all.
    pub(crate) const NONE: Self = Self(u32::MAX);

    pub(crate) fn site(id: u32) -> Self {
        debug_assert!(id < FIRST_WALL);
        Self(id)
    }

    pub(crate) fn wall(wall: Wall) -> Self {
        Self(FIRST_WALL + u32::from(wall.0))
    }

    pub(crate) fn as_site(self) -> Option<u32> {
        (self.0 < FIRST_WALL).then_some(self.0)
    }

    pub(crate) fn plane(self) -> Plane {
        match self.as_site() {
            Some(id) => Plane::Site(id),
            None => Plane::Wall(Wall::ALL[(self.0 - FIRST_WALL) as usize]),
        }
    }
}

/// The four generators whose bisectors and walls meet in a vertex in general position, sorted.
pub(crate) type VertexKey = [Generator; 4];
