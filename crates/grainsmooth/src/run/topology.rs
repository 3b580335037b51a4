//! How many faces grains have, and how many of them meet.

use std::collections::BTreeMap;
use std::fmt;

use polycrystal::Network;
use serde::Serialize;
use voronoi::Dimension;

/// Faces a grain, and junctions by what meets there.
///
/// Generic networks have lines of three boundaries and points of four grains (in the plane: of three). What has more is there
/// because edges collapsed, or in the seeds, as in lattices.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Topology {
    #[serde(skip)]
    dimension: Dimension,
    /// Mean number of faces of the flat cells, those on walls included; in the plane, of sides. Nothing where grains come from no cells.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub faces_before: Option<f64>,
    /// The same of the grains.
    pub faces: f64,
    /// Lines by the number of boundaries that meet there, from three; none in the plane.
    pub lines_by_boundaries: BTreeMap<u8, usize>,
    /// Points by the number of grains that meet there, the exterior being one more, from four; in the plane from three.
    pub points_by_grains: BTreeMap<u8, usize>,
}

impl Topology {
    /// That of a network and of the faces that its grains had as cells. Of periodic copies one counts.
    pub(crate) fn new(faces_of_cells: Option<&[usize]>, network: &Network) -> Self {
        let before = faces_of_cells.map(|faces| faces.iter().sum::<usize>());
        let after = network.boundaries().iter().flat_map(|boundary| boundary.signed_grains()).count();
        let junctions = network.junction_counts();
        let dimension = network.domain().dimension();
        let (lines_by_boundaries, points_by_grains) = match dimension {
            Dimension::Three => (junctions.lines_by_sides.clone(), junctions.points_by_sides.clone()),
            Dimension::Two => (BTreeMap::new(), junctions.lines_by_sides.clone()),
        };
        Self {
            dimension,
            faces_before: before.map(|before| before as f64 / network.grain_count() as f64),
            faces: after as f64 / network.grains_left() as f64,
            lines_by_boundaries,
            points_by_grains,
        }
    }
}

impl fmt::Display for Topology {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { faces, faces_before, lines_by_boundaries, points_by_grains, .. } = self;
        let (points, face) = match self.dimension {
            Dimension::Two => ("triple points", "sides"),
            Dimension::Three => {
                write!(out, "{}, ", Counted("triple lines", "boundaries", lines_by_boundaries))?;
                ("quadruple points", "faces")
            }
        };
        write!(out, "{}; {faces:.2} {face} a grain", Counted(points, "grains", points_by_grains))?;
        match faces_before {
            Some(before) if before != faces => write!(out, ", {before:.2} before relaxation"),
            _ => Ok(()),
        }
    }
}

/// `120 quadruple points (100 of 4 grains, 17 of 5, 3 of 6)`.
struct Counted<'a>(&'static str, &'static str, &'a BTreeMap<u8, usize>);

impl fmt::Display for Counted<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(junctions, what, counts) = self;
        write!(out, "{} {junctions}", counts.values().sum::<usize>())?;
        let mut counts = counts.iter();
        let Some((first, count)) = counts.next() else { return Ok(()) };
        write!(out, " ({count} of {first} {what}")?;
        counts.try_for_each(|(number, count)| write!(out, ", {count} of {number}"))?;
        write!(out, ")")
    }
}
