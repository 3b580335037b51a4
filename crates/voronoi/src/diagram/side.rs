use crate::exact::face_end::FaceEnd;
use crate::exact::image::Image;
use crate::{CellId, Shift, Wall};

/// What lies on one side of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// A cell.
    Cell(CellId),
    /// A cell of a periodic domain, moved by whole periods from where it stands.
    Image(CellId, Shift),
    /// The outside of the domain, beyond a wall.
    Wall(Wall),
}

impl Side {
    /// The cell, and by how much it is moved; nothing for a wall.
    pub fn cell(self) -> Option<(CellId, Shift)> {
        match self {
            Self::Cell(cell) => Some((cell, Shift::NONE)),
            Self::Image(cell, shift) => Some((cell, shift)),
            Self::Wall(_) => None,
        }
    }

    /// What lies there where all is moved by whole periods.
    #[must_use]
    pub fn moved(self, shift: Shift) -> Self {
        Self::of(self.end(), shift)
    }

    /// What lies on a side of a face that is moved by `shift`.
    pub(crate) fn of(end: FaceEnd, shift: Shift) -> Self {
        match end {
            FaceEnd::Cell(image) => match image.shift + shift {
                Shift::NONE => Self::Cell(CellId(image.seed)),
                shift => Self::Image(CellId(image.seed), shift),
            },
            FaceEnd::Wall(wall) => Self::Wall(wall),
        }
    }

    /// What lies on a side of a face that is in its own place.
    pub(crate) fn end(self) -> FaceEnd {
        match self {
            Self::Cell(CellId(seed)) => FaceEnd::Cell(Image { seed, shift: Shift::NONE }),
            Self::Image(CellId(seed), shift) => FaceEnd::Cell(Image { seed, shift }),
            Self::Wall(wall) => FaceEnd::Wall(wall),
        }
    }
}
