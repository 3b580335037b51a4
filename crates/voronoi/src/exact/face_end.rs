use crate::exact::image::Image;
use crate::{Shift, Wall};

/// What lies on one side of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum FaceEnd {
    Cell(Image),
    Wall(Wall),
}

impl FaceEnd {
    pub(crate) fn moved(self, shift: Shift) -> Self {
        match self {
            Self::Cell(image) => Self::Cell(Image { shift: image.shift + shift, ..image }),
            Self::Wall(wall) => Self::Wall(wall),
        }
    }

    pub(crate) fn shift(self) -> Shift {
        match self {
            Self::Cell(image) => image.shift,
            Self::Wall(_) => Shift::NONE,
        }
    }

    pub(crate) fn is(self, cell: u32) -> bool {
        matches!(self, Self::Cell(image) if image.seed == cell)
    }
}
