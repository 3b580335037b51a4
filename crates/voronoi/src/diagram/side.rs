use crate::exact::face_end::FaceEnd;
use crate::exact::image::Image;
use crate::{CellId, Translation, Wall};

/// What lies on one side of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// A cell.
    Cell(CellId),
    /// A cell of a periodic domain, moved by whole periods from where it stands.
    Image(CellId, Translation),
    /// The outside of the domain, beyond a wall.
    Wall(Wall),
}

impl Side {
    /// The cell, and by how much it is moved; nothing for a wall.
    pub fn cell(self) -> Option<(CellId, Translation)> {
        match self {
            Self::Cell(cell) => Some((cell, Translation::ZERO)),
            Self::Image(cell, translation) => Some((cell, translation)),
            Self::Wall(_) => None,
        }
    }

    /// What lies there where all is moved by whole periods.
    #[must_use]
    pub fn moved(self, translation: Translation) -> Self {
        Self::of(self.end(), translation)
    }

    /// What lies on a side of a face that is moved by `translation`.
    pub(crate) fn of(end: FaceEnd, translation: Translation) -> Self {
        match end {
            FaceEnd::Cell(image) => match image.translation + translation {
                Translation::ZERO => Self::Cell(CellId(image.seed)),
                translation => Self::Image(CellId(image.seed), translation),
            },
            FaceEnd::Wall(wall) => Self::Wall(wall),
        }
    }

    /// What lies on a side of a face that is in its own place.
    pub(crate) fn end(self) -> FaceEnd {
        match self {
            Self::Cell(CellId(seed)) => FaceEnd::Cell(Image { seed, translation: Translation::ZERO }),
            Self::Image(CellId(seed), translation) => FaceEnd::Cell(Image { seed, translation }),
            Self::Wall(wall) => FaceEnd::Wall(wall),
        }
    }
}
