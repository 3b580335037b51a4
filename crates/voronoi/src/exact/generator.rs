use crate::Wall;

/// Most walls of a polyhedron: that many numbers of 32 bits stand for walls, and not for sites.
pub(crate) const MOST_WALLS: u16 = 1 << 15;

/// In two dimensions the plane z = 0 is a third plane through every corner, so that polygons are faces of polyhedra.
pub(crate) const PLANE: Wall = Wall::ALL[5];

/// What a cell's plane comes from: a site (the bisector with it) or a wall of the domain. Sites sort before walls.
///
/// Sites are the seeds, by number, then the periodic images of seeds. A side of the domain's box is a wall unless the domain
/// repeats along its axis, where it stands for the plane half a period away from the cell's own seed, or is a polyhedron,
/// around which the box has room to spare; no finished cell has such a plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub(crate) struct Generator(pub(crate) u32);

/// A generator, told apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Plane {
    Site(u32),
    /// A side of the domain's box.
    Side(Wall),
    /// A wall of a polyhedron.
    Facet(Wall),
}

/// First code of a side; the six sides take the last codes that 32 bits offer but one, which stays free.
const FIRST_SIDE: u32 = u32::MAX - 7;

/// First code of a wall of a polyhedron.
const FIRST_FACET: u32 = FIRST_SIDE - MOST_WALLS as u32;

impl Generator {
    /// Number of sites that can be told from walls.
    pub(crate) const MAX_SITES: usize = FIRST_FACET as usize;

    /// No generator at all.
    pub(crate) const NONE: Self = Self(u32::MAX);

    pub(crate) fn site(id: u32) -> Self {
        debug_assert!(id < FIRST_FACET);
        Self(id)
    }

    pub(crate) fn side(wall: Wall) -> Self {
        Self(FIRST_SIDE + wall.0)
    }

    pub(crate) fn facet(wall: Wall) -> Self {
        Self(FIRST_FACET + wall.0)
    }

    #[inline]
    pub(crate) fn as_site(self) -> Option<u32> {
        (self.0 < FIRST_FACET).then_some(self.0)
    }

    #[inline]
    pub(crate) fn plane(self) -> Plane {
        match self.0 {
            site if site < FIRST_FACET => Plane::Site(site),
            code if code < FIRST_SIDE => Plane::Facet(Wall(code - FIRST_FACET)),
            code => Plane::Side(Wall::ALL[(code - FIRST_SIDE) as usize]),
        }
    }
}

/// The four generators whose bisectors and walls meet in a vertex in general position, sorted.
pub(crate) type VertexKey = [Generator; 4];
