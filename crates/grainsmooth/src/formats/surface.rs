//! The triangles of a network, or of one of its grains, boundary by boundary.

use std::borrow::Cow;
use std::io::{self, Write};
use std::ops::Range;

use glam::DVec3;
use polycrystal::{Boundary, BoundaryId, Elements, GrainId, LevelView, Side};

use crate::Polycrystal;
use crate::names::SEED_ID;

/// Seeds named by a line of comments, which so stays below the 255 bytes that some readers know.
const SEEDS_A_LINE: usize = 20;

/// Triangles that share points, in parts: one for each boundary.
pub(crate) struct Surface<'a> {
    /// All points, each once.
    pub(crate) points: Cow<'a, [DVec3]>,
    triangles: Triangles<'a>,
    /// The triangles, by number, part after part.
    order: Vec<u32>,
    /// The boundaries.
    pub(crate) parts: Vec<Part>,
}

/// The triangles of a surface, by number.
enum Triangles<'a> {
    /// Of a level of a network.
    OfLevel(Elements<'a>),
    /// Of the surface itself.
    Own(Cow<'a, [[u32; 3]]>),
}

impl Triangles<'_> {
    fn len(&self) -> usize {
        match self {
            Self::OfLevel(elements) => elements.len(),
            Self::Own(triangles) => triangles.len(),
        }
    }

    fn get(&self, triangle: u32) -> [u32; 3] {
        match self {
            Self::OfLevel(elements) => {
                let corners = elements.corners(triangle);
                [0, 1, 2].map(|k| corners[k])
            }
            Self::Own(triangles) => triangles[triangle as usize],
        }
    }
}

/// The triangles of one boundary.
#[derive(Debug, Clone)]
pub(crate) struct Part {
    /// The boundary.
    pub(crate) boundary: BoundaryId,
    /// What the triangles' normals point from and to.
    pub(crate) sides: [Side; 2],
    range: Range<usize>,
}

impl<'a> Surface<'a> {
    /// The finest level of a polycrystal, every boundary once; nothing in the plane, where boundaries are lines.
    pub(crate) fn network(polycrystal: &'a Polycrystal) -> Option<Self> {
        Self::of_level(polycrystal, polycrystal.network.finest())
    }

    /// The same with the triangles of a coarser level, whose vertices stand where they are on the finest.
    pub(crate) fn of_level(polycrystal: &'a Polycrystal, level: LevelView<'a>) -> Option<Self> {
        if let Elements::Segments(_) = level.elements() {
            return None;
        }
        let boundaries = polycrystal.network.boundaries();
        let (order, ranges) = grouped(level, boundaries.len());
        let numbered = (0u32..).map(BoundaryId).zip(boundaries).zip(ranges);
        let part = |((id, boundary), range): ((BoundaryId, &Boundary), Range<usize>)| Part {
            boundary: id,
            sides: boundary.sides,
            range,
        };
        Some(Self {
            points: Cow::Borrowed(&polycrystal.points[..level.vertex_count()]),
            triangles: Triangles::OfLevel(level.elements()),
            order,
            parts: numbered.map(part).collect(),
        })
    }

    /// The same points and triangles in other parts, each with its boundary, its sides and its triangles by number.
    pub(crate) fn with_parts(&self, parts: Vec<(BoundaryId, [Side; 2], Vec<u32>)>) -> Surface<'_> {
        let mut order = Vec::with_capacity(self.order.len());
        let part = |(boundary, sides, triangles): (BoundaryId, [Side; 2], Vec<u32>)| {
            let start = order.len();
            order.extend(triangles);
            Part { boundary, sides, range: start..order.len() }
        };
        let parts = parts.into_iter().map(part).collect();
        let points = Cow::Borrowed(&*self.points);
        let triangles = match &self.triangles {
            Triangles::OfLevel(elements) => Triangles::OfLevel(*elements),
            Triangles::Own(triangles) => Triangles::Own(Cow::Borrowed(&**triangles)),
        };
        Surface { points, triangles, order, parts }
    }

    /// Number of triangles.
    pub(crate) fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// The triangles of a part, by number.
    pub(crate) fn numbers_of(&self, part: &Part) -> &[u32] {
        &self.order[part.range.clone()]
    }

    /// The triangles of a part.
    pub(crate) fn triangles_of(&self, part: &Part) -> impl Iterator<Item = [u32; 3]> {
        self.order[part.range.clone()].iter().map(|&triangle| self.triangles.get(triangle))
    }

    /// All triangles, part after part.
    pub(crate) fn triangles(&self) -> impl ExactSizeIterator<Item = [u32; 3]> {
        self.order.iter().map(|&triangle| self.triangles.get(triangle))
    }

    /// The corners of a triangle.
    pub(crate) fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|point| self.points[point as usize])
    }

    /// For each grain, its parts by number; true for those whose normals point into the grain.
    pub(crate) fn parts_of_grains(&self, grain_count: usize) -> Vec<Vec<(usize, bool)>> {
        let mut parts = vec![Vec::new(); grain_count];
        for (number, part) in self.parts.iter().enumerate() {
            for (side, is_inward) in part.sides.iter().zip([false, true]) {
                if let Side::Grain(grain) = side {
                    parts[grain.index()].push((number, is_inward));
                }
            }
        }
        parts
    }

    /// The closed surface of a grain, which has these parts: points of its own, all normals outward.
    pub(crate) fn grain(&self, grain: GrainId, parts: &[(usize, bool)]) -> Surface<'static> {
        let mut ids: Vec<u32> =
            parts.iter().flat_map(|&(part, _)| self.triangles_of(&self.parts[part]).flatten()).collect();
        ids.sort_unstable();
        ids.dedup();
        let renumbered = |id: u32| {
            let place = ids.binary_search(&id).expect("all ids of the grain are listed");
            u32::try_from(place).expect("a grain has no more points than the network")
        };
        let mut surface = Surface {
            points: ids.iter().map(|&id| self.points[id as usize]).collect(),
            triangles: Triangles::Own(Cow::default()),
            order: Vec::new(),
            parts: Vec::with_capacity(parts.len()),
        };
        let mut triangles = Vec::new();
        for &(number, is_inward) in parts {
            let part = &self.parts[number];
            let start = triangles.len();
            triangles.extend(self.triangles_of(part).map(|corners| {
                let [a, b, c] = corners.map(renumbered);
                if is_inward { [a, c, b] } else { [a, b, c] }
            }));
            let beyond = part.sides[usize::from(!is_inward)];
            surface.parts.push(Part {
                boundary: part.boundary,
                sides: [Side::Grain(grain), beyond],
                range: start..triangles.len(),
            });
        }
        surface.order = (0u32..).take(triangles.len()).collect();
        surface.triangles = Triangles::Own(Cow::Owned(triangles));
        surface
    }
}

/// The numbers of all elements ordered by boundary, and where each boundary's stand.
fn grouped(level: LevelView<'_>, boundary_count: usize) -> (Vec<u32>, Vec<Range<usize>>) {
    let elements = 0..u32::try_from(level.element_count()).expect("ids fit 32 bits");
    let mut starts = vec![0; boundary_count + 1];
    for element in elements.clone() {
        starts[level.boundary(element).index() + 1] += 1;
    }
    for boundary in 0..boundary_count {
        starts[boundary + 1] += starts[boundary];
    }
    let ranges: Vec<Range<usize>> = starts.windows(2).map(|ends| ends[0]..ends[1]).collect();
    let mut order = vec![0; level.element_count()];
    for element in elements {
        let next = &mut starts[level.boundary(element).index()];
        order[*next] = element;
        *next += 1;
    }
    (order, ranges)
}

/// A side as file formats number it: the grain, or -1 for the exterior.
pub(crate) fn label(side: Side) -> i64 {
    match side {
        Side::Grain(grain) => i64::from(grain.0),
        Side::Exterior => -1,
    }
}

/// A side as file formats name it.
pub(crate) fn side_name(side: Side) -> String {
    match side {
        Side::Grain(grain) => format!("grain{}", grain.0),
        Side::Exterior => "exterior".to_owned(),
    }
}

/// Writes the numbers of grains' seeds, in the order of the grains, with a format's sign for comments before each line.
pub(crate) fn write_seed_comments(seed_ids: &[u32], sign: &str, out: &mut dyn Write) -> io::Result<()> {
    seed_ids.chunks(SEEDS_A_LINE).try_for_each(|ids| {
        let ids: Vec<String> = ids.iter().map(u32::to_string).collect();
        writeln!(out, "{sign}{SEED_ID} {}", ids.join(" "))
    })
}
