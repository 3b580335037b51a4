use crate::{Boundary, Side};

/// What a point is part of, in DREAM.3D's codes: 2 inside a boundary, 3 on a triple line, 4 a quadruple point; 10 more on
/// the domain's outer surface, in a periodic domain that of all whole grains together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeType(i8);

impl NodeType {
    /// Inside a boundary between two grains.
    pub const INTERIOR: Self = Self(2);

    /// Inside a boundary on the domain's outer surface.
    pub const OUTER: Self = Self(12);

    /// The type of a point inside a boundary.
    fn inside(boundary: &Boundary) -> Self {
        if boundary.is_interior() { Self::INTERIOR } else { Self::OUTER }
    }

    /// The type of a point by the sides that meet there, sorted and without duplicates. The exterior counts as one side.
    pub fn of_sides(sides: &[Side]) -> Self {
        Meeting::of_sides(sides).node_type
    }

    /// The type of a point where so many sides meet.
    fn new(side_count: usize, is_outer: bool) -> Self {
        // DREAM.3D knows no more than four grains: what has more counts as a quadruple point.
        let kind = match side_count {
            0..=2 => 2,
            3 => 3,
            _ => 4,
        };
        Self(if is_outer { kind + 10 } else { kind })
    }

    /// Number of sides that meet, from 2 to 4; what has more counts as 4.
    pub(crate) fn side_count(self) -> i8 {
        self.0 % 10
    }

    /// Whether a point lies on the domain's outer surface.
    pub(crate) fn is_outer(self) -> bool {
        self.0 >= 10
    }

    /// The type of a code, if it is one: 2 to 4 or 12 to 14.
    pub fn of_code(code: i8) -> Option<Self> {
        matches!(code, 2..=4 | 12..=14).then_some(Self(code))
    }

    /// The code.
    pub fn code(self) -> i8 {
        self.0
    }
}

/// What meets at a point, or along a line. Of the counts, 255 stands for that many and more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Meeting {
    pub(crate) node_type: NodeType,
    /// Number of sides; the exterior is one of them.
    pub(crate) sides: u8,
    /// Number of grains.
    pub(crate) grains: u8,
}

impl Meeting {
    /// What meets where there are so many sides, of which so many are grains.
    pub(crate) fn new(sides: usize, grains: usize, is_outer: bool) -> Self {
        let [side_count, grains] = [sides, grains].map(|count| u8::try_from(count).unwrap_or(u8::MAX));
        Self { node_type: NodeType::new(sides, is_outer), sides: side_count, grains }
    }

    /// What meets where these sides do, sorted and without duplicates.
    pub(crate) fn of_sides(sides: &[Side]) -> Self {
        let grains = sides.iter().filter(|side| side.grain().is_some()).count();
        Self::new(sides.len(), grains, sides.contains(&Side::Exterior))
    }

    /// What meets inside a boundary.
    pub(crate) fn inside(boundary: &Boundary) -> Self {
        let is_between_grains = boundary.is_interior() || boundary.twin.is_some();
        let grains = if is_between_grains { 2 } else { 1 };
        Self { node_type: NodeType::inside(boundary), sides: 2, grains }
    }
}
