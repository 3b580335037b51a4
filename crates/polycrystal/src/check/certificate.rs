use std::collections::BTreeMap;
use std::fmt;

use cancellation::check_cancelled;
use glam::DVec3;
use rayon::prelude::*;

use crate::check::boundary_survey::BoundarySurvey;
use crate::check::closedness::closedness_faults;
use crate::check::fault::Fault;
use crate::check::intersections::crossing_elements;
use crate::check::nesting::Pieces;
use crate::check::pinched_points::pinched_points;
use crate::mesh::adjacency::Adjacency;
use crate::mesh::angles::angles;
use crate::mesh::boundary_elements::BoundaryElements;
use crate::mesh::id::id;
use crate::mesh::node_type::Meeting;
use crate::mesh::rounding::swept_by_rounding;
use crate::mesh::volume::{Cone, ConeSum};
use crate::{AngleStatistics, GrainId, NodeType, Side, Surface, TriangleQuality};

/// Largest difference of a volume from what it should be, as a share of that.
pub(crate) const VOLUME_TOLERANCE: f64 = 1e-9;

/// What is said about a surface, to be compared with what it is.
///
/// Of refined elements, types, numbers of grains and originals are those of the points of the mesh that they come from, refined once: what points are that are
/// born later follows.
#[derive(Debug, Clone, Copy, Default)]
pub struct Expected<'a> {
    /// Type of each point; nothing where a file leaves it open.
    pub node_types: Option<&'a [Option<NodeType>]>,
    /// Number of grains at each point, see [`Level::grain_counts`](crate::Level::grain_counts).
    pub grain_counts: Option<&'a [u8]>,
    /// In a periodic network, the point that each point is a copy of, or itself: grains at all copies meet there.
    pub originals: Option<&'a [u32]>,
    /// Volume of each grain (in the plane: area).
    pub grain_volumes: Option<&'a [(GrainId, f64)]>,
    /// Volume of the domain (in the plane: area).
    pub domain_volume: Option<f64>,
    /// How far each coordinate may be from what the volumes were measured on: [`Surface::last_place`], or half a last place of
    /// single precision, where that is how points were kept since.
    pub rounding: f64,
}

/// What was found about a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// All that is wrong, kind by kind; nothing if the network is valid.
    pub faults: Faults,
    /// Volume of each grain (in the plane: area); in order of the grains' numbers.
    pub grain_volumes: Vec<(GrainId, f64)>,
    /// Largest difference of a grain's volume from the claimed, as a share of that; 0 when nothing was claimed.
    pub largest_volume_error: f64,
    /// Difference of the total volume from the domain's, as a share of that; 0 when nothing was claimed.
    pub total_volume_error: f64,
    /// Angles between boundaries, if boundaries meet inside the domain.
    pub angles: Option<AngleStatistics>,
    /// How thin triangles are, in space.
    pub triangles: Option<TriangleQuality>,
}

/// What is wrong with a surface. Its text names the first fault of each kind.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Faults(pub Vec<Fault>);

impl std::error::Error for Faults {}

impl Faults {
    /// The first grain whose surface touches itself, where all faults are of that kind.
    pub(crate) fn pinched_grain(&self) -> Option<GrainId> {
        let pinched = self.0.iter().map(|fault| match fault {
            Fault::Pinched { grain, .. } | Fault::PinchedPoint { grain, .. } => Some(*grain),
            _ => None,
        });
        pinched.collect::<Option<Vec<_>>>()?.first().copied()
    }
}

impl fmt::Display for Faults {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kinds = self.0.chunk_by(|a, b| a.kind() == b.kind());
        for (index, faults) in kinds.enumerate() {
            let start = if index == 0 { "" } else { "; " };
            write!(out, "{start}{}", faults[0])?;
            if faults.len() > 1 {
                write!(out, " ({} such)", faults.len())?;
            }
        }
        Ok(())
    }
}

/// Looks for all that can be wrong with a network: points and elements that should not be there, grains that are not closed
/// or wind the wrong way, folds, elements that cross and grains inside others that lie outside them (both decided exactly), and expected that do
/// not hold.
///
/// Where a point is not finite the search ends with these points, and where the grains are not closed volumes are not
/// compared with expected.
///
/// ```
/// use glam::DVec3;
/// use polycrystal::{Expected, Fault, Junctions, Network, Surface, certify};
/// use voronoi::{Domain, Tessellation};
///
/// let seeds = [DVec3::new(0.3, 0.4, 0.5), DVec3::new(0.7, 0.3, 0.2), DVec3::new(0.6, 0.8, 0.9)];
/// let cells = Tessellation::new(&Domain::unit_cube(), &seeds)?;
/// let (network, mut points) = Network::new(&cells, Junctions::Crease, 0)?;
/// let sides = network.sides();
/// let certified = |points: &[DVec3]| certify(&Surface::of_level(network.finest(), points, &sides), &Expected::default());
/// assert!(certified(&points).is_good());
/// points[7].x = f64::NAN;
/// assert_eq!(certified(&points).faults.0, [Fault::NotFinite { point: 7 }]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Panics
/// When elements refer to points or boundaries that there are not, or expected are not as many as points.
pub fn certify(surface: &Surface<'_>, expected: &Expected<'_>) -> Certificate {
    inspect(surface, &Adjacency::of_elements(surface.elements, surface.boundary_of), expected)
}

/// The same with adjacency that are known.
pub(crate) fn inspect(
    surface: &Surface<'_>,
    adjacency: &Adjacency<'_>,
    expected: &Expected<'_>,
) -> Certificate {
    let mut certificate = Certificate {
        faults: Faults::default(),
        grain_volumes: Vec::new(),
        largest_volume_error: 0.0,
        total_volume_error: 0.0,
        angles: None,
        triangles: None,
    };
    let not_finite =
        (0..id(surface.points.len())).filter(|point| !surface.points[*point as usize].is_finite());
    certificate.faults.0.extend(not_finite.map(|point| Fault::NotFinite { point }));
    if !certificate.faults.0.is_empty() {
        return certificate;
    }
    check_cancelled();
    let boundaries = BoundaryElements::new(surface);
    let survey = BoundarySurvey::new(surface, &boundaries, adjacency);
    certificate.triangles = survey.triangles;
    let faults = &mut certificate.faults.0;
    faults.extend(survey.flat.iter().map(|element| Fault::NoArea { element: *element }));
    // Each of these runs for the most part on one thread.
    let of_angles = || AngleStatistics::of(angles(surface, surface.sides, adjacency.non_manifold_edges()));
    let ((crossing, angles), (meetings, ((closing, is_closed), pieces))) = rayon::join(
        || rayon::join(|| crossing_elements(surface, adjacency, &boundaries, &survey.extents), of_angles),
        || {
            rayon::join(
                || meetings(surface, &boundaries),
                || (closedness_and_pinches(surface, adjacency), Pieces::new(surface)),
            )
        },
    );
    certificate.angles = angles;
    // Elements at two points in one place cross, or have no area.
    let has_orphans = meetings.contains(&None);
    if has_orphans || !crossing.is_empty() || !survey.flat.is_empty() {
        let duplicates = duplicate_points(surface.points);
        faults.extend(duplicates.map(|points| Fault::DuplicatePoints { points }));
    }
    let orphans = (0..id(meetings.len())).filter(|point| meetings[*point as usize].is_none());
    faults.extend(orphans.map(|point| Fault::Orphan { point }));
    faults.extend(closing);
    let folded = survey.folded.into_iter();
    faults.extend(folded.map(|elements| Fault::Folded { elements, grains: surface.grains_at(elements) }));
    // What is open or crosses is nowhere as a whole.
    let is_somewhere = is_closed && crossing.is_empty();
    let crossing = crossing.into_iter();
    faults.extend(crossing.map(|elements| Fault::Crossing { elements, grains: surface.grains_at(elements) }));
    if is_somewhere {
        faults.extend(pieces.misplaced(surface, &boundaries, &survey.extents));
    }
    if let Some(stated) = expected.node_types {
        faults.extend(wrong_node_types(stated, &meetings));
    }
    if let Some(stated) = expected.grain_counts {
        faults.extend(wrong_grain_counts(stated, &grain_counts(&meetings, expected.originals)));
    }
    certificate.grain_volumes = grain_volumes(surface, &survey.cones);
    let areas = if expected.rounding > 0.0 { side_areas(surface, &survey.areas) } else { BTreeMap::new() };
    certificate.check_volumes(surface, &areas, expected, is_closed);
    certificate
}

/// Where grains are not closed, or are but touch themselves, and whether they are closed.
///
/// Refined elements are and do as what they come from: halves of an edge have the sides around them that it has, edges inside an element have its
/// own, and around a new point there are such edges alone.
fn closedness_and_pinches(surface: &Surface<'_>, adjacency: &Adjacency<'_>) -> (Vec<Fault>, bool) {
    let coarse = surface.refined_at_most(0);
    if coarse.elements.len() < surface.elements.len() {
        let (faults, is_closed) =
            closedness_and_pinches(&coarse, &Adjacency::of_elements(coarse.elements, coarse.boundary_of));
        if faults.is_empty() {
            return (faults, is_closed);
        }
    }
    let mut faults = closedness_faults(surface, adjacency);
    let is_closed = faults.is_empty();
    if is_closed {
        faults = pinched_points(surface, adjacency);
    }
    faults.sort_by_key(Fault::kind);
    (faults, is_closed)
}

impl Certificate {
    /// Whether nothing is wrong.
    pub fn is_good(&self) -> bool {
        self.faults.0.is_empty()
    }

    fn check_volumes(
        &mut self,
        surface: &Surface<'_>,
        areas: &BTreeMap<Side, f64>,
        expected: &Expected<'_>,
        is_closed: bool,
    ) {
        let faults = &mut self.faults.0;
        let empty = self.grain_volumes.iter().filter(|(_, volume)| is_closed && *volume <= 0.0);
        faults.extend(empty.map(|&(grain, volume)| Fault::NoVolume { grain, volume }));
        let mut wrong = Vec::new();
        for (grain, claimed) in expected.grain_volumes.into_iter().flatten() {
            let Ok(found) = self.grain_volumes.binary_search_by_key(grain, |(grain, _)| *grain) else {
                // A grain without volume has vanished.
                if *claimed != 0.0 {
                    faults.push(Fault::MissingGrain { grain: *grain });
                }
                continue;
            };
            let relative_error = (self.grain_volumes[found].1 / claimed - 1.0).abs();
            self.largest_volume_error = self.largest_volume_error.max(relative_error);
            let area = areas.get(&Side::Grain(*grain)).copied().unwrap_or(0.0);
            let tolerance = VOLUME_TOLERANCE + swept_by_rounding(expected.rounding, area) / claimed;
            let is_right = relative_error <= tolerance;
            if is_closed && !is_right {
                let diameter = surface.elements.dimension().ball_diameter(*claimed);
                wrong.push(Fault::WrongVolume { grain: *grain, diameter, relative_error });
            }
        }
        if let Some(claimed) = expected.grain_volumes {
            let mut known: Vec<GrainId> = claimed.iter().map(|(grain, _)| *grain).collect();
            known.sort_unstable();
            let unknown = self.grain_volumes.iter().filter(|(grain, _)| known.binary_search(grain).is_err());
            faults.extend(unknown.map(|(grain, _)| Fault::UnknownGrain { grain: *grain }));
        }
        faults.append(&mut wrong);
        if let Some(whole) = expected.domain_volume {
            let total: f64 = self.grain_volumes.iter().map(|(_, volume)| volume).sum();
            let relative_error = (total / whole - 1.0).abs();
            self.total_volume_error = relative_error;
            let outside = areas.get(&Side::Exterior).copied().unwrap_or(0.0);
            let tolerance = VOLUME_TOLERANCE + swept_by_rounding(expected.rounding, outside) / whole;
            let is_right = relative_error <= tolerance;
            if is_closed && !is_right {
                faults.push(Fault::WrongTotal { relative_error });
            }
        }
    }
}

/// The area (in the plane: length) of each side's surface, given that of each boundary.
fn side_areas(surface: &Surface<'_>, of_boundaries: &[f64]) -> BTreeMap<Side, f64> {
    let mut areas = BTreeMap::new();
    for (area, sides) in of_boundaries.iter().zip(surface.sides) {
        for side in sides {
            *areas.entry(*side).or_default() += *area;
        }
    }
    areas
}

/// Points with the coordinates of an earlier one, each with the first of these.
fn duplicate_points(points: &[DVec3]) -> impl Iterator<Item = [u32; 2]> {
    // Adding zero gives -0 the bits of 0.
    let bits = |point: u32| (points[point as usize] + DVec3::ZERO).to_array().map(f64::to_bits);
    let count = u32::try_from(points.len()).expect("ids fit 32 bits");
    // Sorting short keys is fast, and points of equal keys are few.
    let key = |point: u32| {
        let [x, y, z] = bits(point);
        let mixed =
            x.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ y.rotate_left(23).wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
        (mixed ^ z.rotate_left(41)).wrapping_mul(0x1656_67b1_9e37_79f9)
    };
    let mut keys: Vec<u64> = (0..count).into_par_iter().map(|point| join(high(key(point)), point)).collect();
    keys.par_sort_unstable();
    let mut pairs = Vec::new();
    for equal in keys.chunk_by(|a, b| high(*a) == high(*b)).filter(|equal| equal.len() > 1) {
        let mut same: Vec<([u64; 3], u32)> = equal.iter().map(|at| (bits(low(*at)), low(*at))).collect();
        same.sort_unstable();
        for same in same.chunk_by(|a, b| a.0 == b.0) {
            pairs.extend(same[1..].iter().map(|(_, point)| [same[0].1, *point]));
        }
    }
    pairs.sort_unstable();
    pairs.into_iter()
}

/// What meets at each point by the sides around it; nothing where there is no element. Of refined elements, for the points of what they come from, refined
/// once: those born later are inside the same edges and elements.
fn meetings(surface: &Surface<'_>, boundaries: &BoundaryElements<'_>) -> Vec<Option<Meeting>> {
    const NONE: u32 = u32::MAX;
    let surface = surface.refined_at_most(1);
    let mut first = vec![NONE; surface.points.len()];
    // Points with further boundaries.
    let mut around: Vec<u64> = Vec::new();
    let mut of_others = Vec::new();
    for boundary in 0..id(boundaries.boundary_count()) {
        of_others.clear();
        for labelled in boundaries.labelled(boundary as usize) {
            surface.elements.for_each_vertex_in(*labelled, |point| match &mut first[point as usize] {
                first if *first == NONE => *first = boundary,
                first if *first != boundary => of_others.push(point),
                _ => {}
            });
        }
        of_others.sort_unstable();
        of_others.dedup();
        around.extend(of_others.iter().map(|point| join(*point, boundary)));
    }
    around.par_sort_unstable();
    let sides_of = |boundary: u32| surface.sides.get(boundary as usize).copied();
    let of_one = |boundary: &u32| {
        let mut sides = sides_of(*boundary)?;
        sides.sort_unstable();
        Some(Meeting::of_sides(&sides))
    };
    let mut meetings: Vec<Option<Meeting>> = first.iter().map(of_one).collect();
    let mut sides: Vec<Side> = Vec::new();
    for at in around.chunk_by(|a, b| high(*a) == high(*b)) {
        let point = high(at[0]) as usize;
        sides.clear();
        sides.extend(sides_of(first[point]).into_iter().flatten());
        sides.extend(at.iter().flat_map(|at| surface.sides[low(*at) as usize]));
        sides.sort_unstable();
        sides.dedup();
        meetings[point] = Some(Meeting::of_sides(&sides));
    }
    meetings
}

/// Two numbers as one, for quick sorting.
fn join(high: u32, low: u32) -> u64 {
    u64::from(high) << 32 | u64::from(low)
}

fn high(joined: u64) -> u32 {
    u32::try_from(joined >> 32).expect("half of the bits")
}

#[allow(clippy::cast_possible_truncation, reason = "the lower half of the bits")]
fn low(joined: u64) -> u32 {
    joined as u32
}

/// The number of grains at each point; where there are copies of it, at all of these together, as each grain there is another image.
fn grain_counts(meetings: &[Option<Meeting>], originals: Option<&[u32]>) -> Vec<u8> {
    let of_point = |at: &Option<Meeting>| at.map_or(0, |at| at.grains);
    let mut counts: Vec<u8> = meetings.iter().map(of_point).collect();
    let Some(originals) = originals else { return counts };
    assert!(originals.len() >= meetings.len(), "one original for each point");
    let originals = &originals[..meetings.len()];
    let copies = || (0u32..).zip(originals).filter(|(point, original)| point != *original);
    for (point, original) in copies() {
        let own = counts[point as usize];
        let of_original = &mut counts[*original as usize];
        *of_original = of_original.saturating_add(own);
    }
    for (point, original) in copies() {
        counts[point as usize] = counts[*original as usize];
    }
    counts
}

fn wrong_grain_counts(stated: &[u8], derived: &[u8]) -> impl Iterator<Item = Fault> {
    assert!(stated.len() >= derived.len(), "one number of grains for each point");
    let points = (0u32..).zip(stated.iter().zip(derived));
    points.filter(|(_, (stated, derived))| stated != derived && **derived > 0).map(
        |(point, (stated, derived))| Fault::WrongGrainCount { point, stated: *stated, derived: *derived },
    )
}

fn wrong_node_types(stated: &[Option<NodeType>], derived: &[Option<Meeting>]) -> impl Iterator<Item = Fault> {
    assert!(stated.len() >= derived.len(), "one node type for each point");
    let points = (0u32..).zip(stated.iter().zip(derived));
    points.filter_map(|(point, types)| match types {
        (Some(stated), Some(derived)) if *stated != derived.node_type => {
            Some(Fault::WrongNodeType { point, stated: *stated, derived: derived.node_type })
        }
        _ => None,
    })
}

fn grain_volumes(surface: &Surface<'_>, cones: &[Cone]) -> Vec<(GrainId, f64)> {
    let mut volumes: BTreeMap<GrainId, ConeSum> = BTreeMap::new();
    for (sides, cone) in surface.sides.iter().zip(cones) {
        for (side, sign) in sides.iter().zip([1.0, -1.0]) {
            if let Side::Grain(grain) = side {
                volumes.entry(*grain).or_default().add(cone, sign);
            }
        }
    }
    volumes.into_iter().map(|(grain, sum)| (grain, sum.volume)).collect()
}
