use crate::exact::image::Image;
use crate::{Translation, Wall};

/// What lies on one side of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum FaceEnd {
    Cell(Image),
    Wall(Wall),
}

impl FaceEnd {
    /// A cell in its own place.
    pub(crate) fn cell(seed: u32) -> Self {
        Self::Cell(Image { seed, translation: Translation::ZERO })
    }

    pub(crate) fn moved(self, translation: Translation) -> Self {
        match self {
            Self::Cell(image) => Self::Cell(Image { translation: image.translation + translation, ..image }),
            Self::Wall(wall) => Self::Wall(wall),
        }
    }

    pub(crate) fn translation(self) -> Translation {
        match self {
            Self::Cell(image) => image.translation,
            Self::Wall(_) => Translation::ZERO,
        }
    }

    pub(crate) fn is(self, cell: u32) -> bool {
        matches!(self, Self::Cell(image) if image.seed == cell)
    }
}
