use std::fmt;

use glam::DVec3;

use crate::{GrainId, NodeType, Side, Surface};

/// What makes a network invalid. Points, elements (triangles, in the plane segments) and grains have the numbers of the
/// surface that was looked at.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// A point has a coordinate that is NaN or infinite.
    #[error("point {point} is not finite")]
    NotFinite {
        /// The point.
        point: u32,
    },
    /// No element uses a point.
    #[error("point {point} belongs to no triangle or segment")]
    Orphan {
        /// The point.
        point: u32,
    },
    /// Two points stand at the same place.
    #[error("points {} and {} coincide", points[0], points[1])]
    DuplicatePoints {
        /// The points, the lower first.
        points: [u32; 2],
    },
    /// An element has no area (in the plane: no length).
    #[error("element {element} has no area or length")]
    NoArea {
        /// The element.
        element: u32,
    },
    /// Two elements have the same corners.
    #[error("elements {} and {} have the same corners", elements[0], elements[1])]
    DuplicateElements {
        /// The elements, the lower first.
        elements: [u32; 2],
    },
    /// The surfaces of grains have a hole.
    #[error("{} not closed at {place}", Grains(grains))]
    Open {
        /// Where.
        place: Place,
        /// The grains.
        grains: Vec<GrainId>,
    },
    /// One element winds against all around it.
    #[error("element {element} winds the wrong way")]
    Turned {
        /// The element.
        element: u32,
    },
    /// One element names other sides than all around it.
    #[error(
        "element {element} lies between {} and {} by its label, but should lie between {} and {}",
        stated[0], stated[1], fitting[0], fitting[1]
    )]
    WrongSides {
        /// The element.
        element: u32,
        /// Its sides as they are.
        stated: [Side; 2],
        /// The sides that would close the grains around.
        fitting: [Side; 2],
    },
    /// Elements wind against each other.
    #[error("elements {elements:?} wind in opposite directions at {place}")]
    Winding {
        /// Where.
        place: Place,
        /// The elements there.
        elements: Vec<u32>,
    },
    /// A grain's surface touches itself.
    #[error("grain {} has {elements} triangles or segments at {place}, where a closed surface has 2", grain.0)]
    Pinched {
        /// Where.
        place: Place,
        /// The grain.
        grain: GrainId,
        /// Number of its elements there.
        elements: usize,
    },
    /// In space, a grain's surface touches itself in one point, with no edge in common.
    #[error("the surface of grain {} touches itself in point {point}: {fans} fans of triangles meet there, not one", grain.0)]
    PinchedPoint {
        /// The point.
        point: u32,
        /// The grain.
        grain: GrainId,
        /// Number of fans of its triangles around the point.
        fans: usize,
    },
    /// Two neighbours in one boundary are folded over each other.
    #[error("elements {} and {} of one boundary are folded by more than 90 degrees", elements[0], elements[1])]
    Folded {
        /// The elements.
        elements: [u32; 2],
        /// The grains beside them.
        grains: Vec<GrainId>,
    },
    /// Two elements cross.
    #[error("elements {} and {} cross each other", elements[0], elements[1])]
    Crossing {
        /// The elements, the lower first.
        elements: [u32; 2],
        /// The grains beside them.
        grains: Vec<GrainId>,
    },
    /// A closed piece of the surface lies elsewhere than in the side that is around it by its own elements.
    #[error("the closed piece of surface at point {point} should lie in {around}, but does not")]
    Misplaced {
        /// A point of it.
        point: u32,
        /// The side that should be around it.
        around: Side,
    },
    /// A point's type is not that of the sides around it.
    #[error("point {point} has the node type {}, but the sides around it make {}", stated.code(), derived.code())]
    WrongNodeType {
        /// The point.
        point: u32,
        /// Its type as it is.
        stated: NodeType,
        /// The type that fits.
        derived: NodeType,
    },
    /// Not as many grains meet at a point as it has.
    #[error("point {point} has {stated} as its number of grains, but {derived} meet there")]
    WrongGrainCount {
        /// The point.
        point: u32,
        /// The number that it has.
        stated: u8,
        /// The number of grains around.
        derived: u8,
    },
    /// A grain has no volume, or a negative one: its surface is turned inside out.
    #[error("grain {} has the volume {volume:e}", grain.0)]
    NoVolume {
        /// The grain.
        grain: GrainId,
        /// Its volume.
        volume: f64,
    },
    /// A grain that should be there has no elements.
    #[error("grain {} is missing: its volume is stated, but nothing bounds it", grain.0)]
    MissingGrain {
        /// The grain.
        grain: GrainId,
    },
    /// There is a grain that should not be there.
    #[error("grain {} has no stated volume", grain.0)]
    UnknownGrain {
        /// The grain.
        grain: GrainId,
    },
    /// A grain does not have the volume that it should.
    #[error("the volume of grain {} has a relative error of {relative_error:.1e}", grain.0)]
    WrongVolume {
        /// The grain.
        grain: GrainId,
        /// The equivalent diameter that it should have.
        diameter: f64,
        /// The difference as a share of the volume that it should have.
        relative_error: f64,
    },
    /// The grains do not fill the domain.
    #[error(
        "the volumes of the grains add up to that of the domain with a relative error of {relative_error:e}"
    )]
    WrongTotal {
        /// The difference as a share of the domain's volume.
        relative_error: f64,
    },
}

/// Where boundaries meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// Along an edge of triangles, between these points.
    Edge([u32; 2]),
    /// In the plane: in a point.
    Point(u32),
}

impl fmt::Display for Place {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Edge([a, b]) => write!(out, "the edge of points {a} and {b}"),
            Self::Point(point) => write!(out, "point {point}"),
        }
    }
}

impl Fault {
    /// The kind of fault in a word or two, such as `open` or `duplicate points`.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::NotFinite { .. } => "not finite",
            Self::Orphan { .. } => "orphan point",
            Self::DuplicatePoints { .. } => "duplicate points",
            Self::NoArea { .. } => "no area",
            Self::DuplicateElements { .. } => "duplicate elements",
            Self::Open { .. } => "open",
            Self::Turned { .. } | Self::Winding { .. } => "winding",
            Self::WrongSides { .. } => "wrong sides",
            Self::Pinched { .. } | Self::PinchedPoint { .. } => "pinched",
            Self::Folded { .. } => "folded",
            Self::Crossing { .. } => "crossing",
            Self::Misplaced { .. } => "misplaced",
            Self::WrongNodeType { .. } => "wrong node type",
            Self::WrongGrainCount { .. } => "wrong number of grains",
            Self::NoVolume { .. } => "no volume",
            Self::MissingGrain { .. } => "missing grain",
            Self::UnknownGrain { .. } => "unknown grain",
            Self::WrongVolume { .. } => "wrong volume",
            Self::WrongTotal { .. } => "wrong total",
        }
    }

    /// The points and elements that the fault names.
    pub fn ids(&self) -> (Vec<u32>, Vec<u32>) {
        match self {
            Self::NotFinite { point }
            | Self::Orphan { point }
            | Self::PinchedPoint { point, .. }
            | Self::Misplaced { point, .. }
            | Self::WrongNodeType { point, .. }
            | Self::WrongGrainCount { point, .. } => (vec![*point], Vec::new()),
            Self::DuplicatePoints { points } => (points.to_vec(), Vec::new()),
            Self::NoArea { element } | Self::Turned { element } | Self::WrongSides { element, .. } => {
                (Vec::new(), vec![*element])
            }
            Self::DuplicateElements { elements }
            | Self::Folded { elements, .. }
            | Self::Crossing { elements, .. } => (Vec::new(), elements.to_vec()),
            Self::Open { place, .. } | Self::Pinched { place, .. } => (place.points(), Vec::new()),
            Self::Winding { place, elements } => (place.points(), elements.clone()),
            _ => (Vec::new(), Vec::new()),
        }
    }

    /// The grains that the fault is about.
    pub fn grains(&self) -> Vec<GrainId> {
        match self {
            Self::Open { grains, .. } | Self::Folded { grains, .. } | Self::Crossing { grains, .. } => {
                grains.clone()
            }
            Self::Pinched { grain, .. }
            | Self::PinchedPoint { grain, .. }
            | Self::NoVolume { grain, .. }
            | Self::MissingGrain { grain }
            | Self::UnknownGrain { grain }
            | Self::WrongVolume { grain, .. } => vec![*grain],
            Self::Misplaced { around, .. } => around.grain().into_iter().collect(),
            Self::WrongSides { stated, .. } => stated.iter().filter_map(|side| side.grain()).collect(),
            _ => Vec::new(),
        }
    }

    /// Where it is, for faults that are somewhere.
    ///
    /// # Panics
    /// When the fault is one of another surface.
    pub fn position(&self, surface: &Surface<'_>) -> Option<DVec3> {
        let (points, elements) = self.ids();
        let points = points.iter().map(|point| surface.points[*point as usize]);
        let elements = elements.iter().map(|element| surface.middle(*element));
        let places: Vec<DVec3> = points.chain(elements).collect();
        (!places.is_empty()).then(|| places.iter().sum::<DVec3>() / places.len() as f64)
    }
}

impl Place {
    fn points(self) -> Vec<u32> {
        match self {
            Self::Edge(ends) => ends.to_vec(),
            Self::Point(point) => vec![point],
        }
    }
}

/// Writes grains as `grain 3 is`, or `grains 3, 17 are`.
struct Grains<'a>(&'a [GrainId]);

impl fmt::Display for Grains<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (noun, verb) = if self.0.len() == 1 { ("grain", "is") } else { ("grains", "are") };
        let names: Vec<String> = self.0.iter().map(|grain| grain.0.to_string()).collect();
        write!(out, "{noun} {} {verb}", names.join(", "))
    }
}
