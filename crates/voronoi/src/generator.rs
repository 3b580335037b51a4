use crate::Wall;
use crate::tessellation::{CellId, Side};

/// What a cell's plane comes from: a seed (the bisector with it) or a wall of the domain. Seeds sort before walls.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Generator(pub(crate) u32);

/// First code of a wall; the six walls take the last codes that 32 bits offer but one, which stays free.
const FIRST_WALL: u32 = u32::MAX - 7;

impl Generator {
    /// Number of seeds that can be told from walls.
    pub(crate) const MAX_SEEDS: usize = FIRST_WALL as usize;

    pub(crate) fn seed(id: u32) -> Self {
        debug_assert!(id < FIRST_WALL);
        Self(id)
    }

    pub(crate) fn wall(wall: Wall) -> Self {
        Self(FIRST_WALL + u32::from(wall.0))
    }

    pub(crate) fn as_seed(self) -> Option<u32> {
        (self.0 < FIRST_WALL).then_some(self.0)
    }

    pub(crate) fn as_wall(self) -> Option<Wall> {
        (self.0 >= FIRST_WALL).then(|| Wall::ALL[(self.0 - FIRST_WALL) as usize])
    }

    pub(crate) fn side(self) -> Side {
        match self.as_wall() {
            None => Side::Cell(CellId(self.0)),
            Some(wall) => Side::Wall(wall),
        }
    }
}
