//! Cells that are divided by a second power diagram each.

use glam::DVec3;
use rayon::prelude::*;

use super::grains::Grains;
use super::newton::{Clipped, approach};
use super::{GOAL, PowerDiagram, VolumesError};
use crate::diagram::measures::face_area_and_centroid;
use crate::{CellId, Dimension, Domain, Side, Tessellation, VoronoiError, WallPlane};

/// How far the seeds of parts stand from their cell's, in units of the way to the points that divide it. Parts meet where those points
/// have it whatever this is, but the surface of the cell bends with it. 200 cells of cv 0.35 in a unit cube, in 890 lamellae of width 0.05: their
/// corners are at most 0.19, 0.059, 0.0058 and 0.00058 of their cell's cube root off that surface at 0.3, 0.1, 0.01 and 0.001 (a tenth of it in the
/// median). The walls between parts are plane within 7e-14 at 0.01 and 8e-12 at 1e-4, and at 1e-6 volumes come no nearer than 1e-9.
const NEARNESS: f64 = 0.01;

/// Volumes below this share of a cell's mean part are left to the parts around: the ends of lamellae at a cell's corners would be grains a
/// fifth as wide as the others else.
const SMALLEST_PART: f64 = 0.1;

/// How often seeds come nearer, until they are inside; the middle of a cell is.
const MOST_HALVINGS: i32 = 60;

/// Beneath this share of a cell's width squared a face is a point or a line, and bounds nothing.
const LEAST_FACE: f64 = 1e-13;

/// What divides a cell: the points of a power diagram, of which the cell gets the part around each. They need not be inside.
#[derive(Debug, Clone, PartialEq)]
pub struct Division {
    /// One point of each part.
    pub points: Vec<DVec3>,
    /// Its weight.
    pub weights: Vec<f64>,
}

/// Cells of which some are divided.
#[derive(Debug, Clone, PartialEq)]
pub struct DividedCells {
    /// The parts, each a cell of its own.
    pub diagram: PowerDiagram,
    /// The cell that each part is of. Parts of one cell follow each other.
    pub cell_of: Vec<CellId>,
    /// Of each part, the number of its point in the cell's [`Division`]; 0 in cells that are not divided.
    pub point_of: Vec<usize>,
}

/// Divides cells by what is given for each; nothing leaves one whole. The parts of a cell fill its volume to [`TOLERANCE`](super::TOLERANCE), and meet in planes
/// of its division; its surface is as it was but for 0.6 % of the
/// cube root of its volume at most.
///
/// All are cells of one power diagram: around a cell's seed c of weight w, the part of a point q has the seed c + e (q - c) and the weight
/// w - e (1 - e) |q - c|^2, as (1 - e) |x - c|^2 + e |x - q|^2 is the squared distance from that seed plus a constant. Then Newton's method gives each part the volume that
/// the cell alone, divided by its points, has there.
///
/// # Errors
/// As of [`PowerDiagram::with_volumes`].
///
/// # Panics
/// When there are not as many weights and divisions as cells, or a division has no points or not as many weights.
pub fn divide_cells(
    tessellation: &Tessellation,
    weights: &[f64],
    divisions: &[Option<Division>],
) -> Result<DividedCells, VolumesError> {
    assert_eq!(tessellation.cell_count(), weights.len(), "one weight for each cell");
    assert_eq!(tessellation.cell_count(), divisions.len(), "one division for each cell");
    let measures = tessellation.cell_measures();
    let cells = (0u32..).map(CellId).take(divisions.len()).collect::<Vec<_>>();
    let parts = cells.par_iter().map(|cell| {
        let (seed, weight) = (tessellation.seeds()[cell.index()], weights[cell.index()]);
        let measure = &measures[cell.index()];
        let whole = Parts {
            seeds: vec![seed],
            weights: vec![weight],
            volumes: vec![measure.volume],
            points: vec![0],
        };
        let Some(division) = &divisions[cell.index()] else { return Ok(whole) };
        assert_eq!(division.points.len(), division.weights.len(), "one weight for each point");
        // All that are empty at once, others one after the other: what takes up the first may be large enough then.
        let too_small = |volumes: &[f64]| {
            let least = SMALLEST_PART * volumes.iter().sum::<f64>() / volumes.len() as f64;
            let smallest = volumes.iter().copied().fold(f64::INFINITY, f64::min);
            if smallest < least { smallest.max(0.0) } else { 0.0 }
        };
        let (volumes, points) =
            part_volumes(&tessellation.cell_domain(*cell)?, measure.centroid, division, too_small)?;
        if points.len() < 2 {
            return Ok(whole);
        }
        let sum: f64 = volumes.iter().sum();
        let volumes = volumes.iter().map(|volume| volume * (measure.volume / sum)).collect();
        let kept = division.of(&points);
        let (seeds, weights) = seeds_of_parts(tessellation, *cell, measure.centroid, weight, &kept, NEARNESS);
        let seeds = seeds.into_iter().map(|seed| tessellation.domain().wrapped(seed)).collect();
        Ok(Parts { seeds, weights, volumes, points })
    });
    let parts = parts.collect::<Result<Vec<_>, VolumesError>>()?;
    let cell_of =
        cells.iter().zip(&parts).flat_map(|(cell, parts)| vec![*cell; parts.points.len()]).collect();
    let all = |of: fn(&Parts) -> &Vec<f64>| parts.iter().flat_map(of).copied().collect::<Vec<f64>>();
    let (weights, volumes) = (all(|parts| &parts.weights), all(|parts| &parts.volumes));
    let seeds: Vec<DVec3> = parts.iter().flat_map(|parts| &parts.seeds).copied().collect();
    let mut state =
        Clipped::new(tessellation.domain(), &seeds, weights, Grains::of_single_cells(seeds.len()))?;
    let newton_steps = approach(&mut state, &volumes, GOAL)?;
    let diagram = PowerDiagram { newton_steps, ..PowerDiagram::finished(state, volumes) };
    Ok(DividedCells {
        diagram,
        cell_of,
        point_of: parts.into_iter().flat_map(|parts| parts.points).collect(),
    })
}

/// The parts of a cell.
struct Parts {
    seeds: Vec<DVec3>,
    weights: Vec<f64>,
    volumes: Vec<f64>,
    /// The point that each is of.
    points: Vec<usize>,
}

impl Division {
    /// The division by some of the points.
    pub(super) fn of(&self, points: &[usize]) -> Self {
        Self {
            points: points.iter().map(|point| self.points[*point]).collect(),
            weights: points.iter().map(|point| self.weights[*point]).collect(),
        }
    }

    /// Seeds of parts and their weights, for a seed of weight 0 and a nearness.
    fn seeds(&self, seed: DVec3, nearness: f64) -> (Vec<DVec3>, Vec<f64>) {
        let pairs = self.points.iter().zip(&self.weights).map(|(point, weight)| {
            let way = *point - seed;
            (seed + nearness * way, nearness * (weight - (1.0 - nearness) * way.length_squared()))
        });
        pairs.unzip()
    }

    /// The least power distance of a place.
    fn distance(&self, place: DVec3) -> f64 {
        let all = self.points.iter().zip(&self.weights);
        all.map(|(point, weight)| place.distance_squared(*point) - weight).fold(f64::INFINITY, f64::min)
    }
}

/// The volumes of the parts that a domain is divided into, and the points that they are of, without those that are empty or not above
/// what `too_small` says of the volumes of all.
pub(super) fn part_volumes(
    domain: &Domain,
    middle: DVec3,
    division: &Division,
    too_small: impl Fn(&[f64]) -> f64,
) -> Result<(Vec<f64>, Vec<usize>), VolumesError> {
    let mut points: Vec<usize> = (0..division.points.len()).collect();
    loop {
        let kept = division.of(&points);
        let seeds_at = |halvings: i32| kept.seeds(middle, 0.5f64.powi(halvings));
        let are_inside =
            |(seeds, _): &(Vec<DVec3>, Vec<f64>)| seeds.iter().all(|seed| domain.contains(*seed));
        let (seeds, weights) =
            (0..MOST_HALVINGS).map(seeds_at).find(are_inside).unwrap_or_else(|| seeds_at(MOST_HALVINGS));
        let parts = Tessellation::power(domain, &seeds, &weights)?;
        let volumes: Vec<f64> = parts.cell_measures().iter().map(|cell| cell.volume).collect();
        let limit = too_small(&volumes);
        if volumes.iter().all(|volume| *volume > limit) {
            return Ok((volumes, points));
        }
        let mut of_points = volumes.iter();
        points.retain(|_| of_points.next().is_none_or(|volume| *volume > limit));
    }
}

/// The seeds of a cell's parts where the cell stands, and their weights, with which the cell's surface stays where it is on average.
pub(super) fn seeds_of_parts(
    tessellation: &Tessellation,
    cell: CellId,
    middle: DVec3,
    weight: f64,
    division: &Division,
    nearness: f64,
) -> (Vec<DVec3>, Vec<f64>) {
    let (domain, seed) = (tessellation.domain(), tessellation.seeds()[cell.index()]);
    let faces = tessellation.cell_faces(cell).iter().map(|face| face_area_and_centroid(tessellation, *face));
    let faces: Vec<(f64, DVec3)> = faces.collect();
    let area: f64 = faces.iter().map(|(area, _)| area).sum();
    let tries = (0..=MOST_HALVINGS).map(|halvings| {
        // The seed may stand on a wall, with points beyond it: then it moves toward the middle, or nearness ends the matter.
        let nearness = nearness * 0.5f64.powi(halvings);
        let seed = if halvings == 0 { seed } else { seed.lerp(middle, NEARNESS) };
        let (seeds, mut weights) = division.seeds(seed, nearness);
        let rise = |(area, place): &(f64, DVec3)| {
            let own = (1.0 - nearness) * place.distance_squared(seed) + nearness * division.distance(*place);
            area * (own - place.distance_squared(tessellation.seeds()[cell.index()]))
        };
        let rise = faces.iter().map(rise).sum::<f64>() / area;
        weights.iter_mut().for_each(|own| *own += weight + rise);
        (seeds, weights)
    });
    let mut last = None;
    for (seeds, weights) in tries {
        let are_inside = seeds.iter().all(|seed| domain.contains(domain.wrapped(*seed)));
        last = Some((seeds, weights));
        if are_inside {
            break;
        }
    }
    last.unwrap_or_default()
}

impl Tessellation {
    /// A cell as a domain of its own, around its seed. Its walls are rounded.
    ///
    /// # Errors
    /// [`VoronoiError`] where the cell is empty, or so thin that rounding leaves it no volume.
    pub fn cell_domain(&self, cell: CellId) -> Result<Domain, VoronoiError> {
        let corners = || self.cell_faces(cell).iter().flat_map(|face| self.face_corners(*face));
        let places = || corners().map(|corner| self.vertices()[corner.index()]);
        let (lower, upper) = places()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lower, upper), place| {
                (lower.min(place), upper.max(place))
            });
        let width = (upper - lower).max_element();
        let is_plane = self.domain().dimension() == Dimension::Two;
        let least = if is_plane { LEAST_FACE.sqrt() * width } else { LEAST_FACE * width * width };
        let wall = |face: &crate::FaceId| {
            let places: Vec<DVec3> =
                self.face_corners(*face).iter().map(|corner| self.vertices()[corner.index()]).collect();
            let toward_second = match places[..] {
                // The first side is to the left.
                [start, end] => DVec3::new(end.y - start.y, start.x - end.x, 0.0),
                _ => {
                    let first = places[0];
                    places[1..].windows(2).map(|ends| (ends[0] - first).cross(ends[1] - first)).sum()
                }
            };
            let is_first = self.face_sides(*face)[0] == Side::Cell(cell);
            let outward = if is_first { toward_second } else { -toward_second };
            let length = outward.length();
            (length > least).then(|| {
                let normal = outward / length;
                // The middle of the corners: they are rounded.
                let offset = places.iter().map(|place| normal.dot(*place)).sum::<f64>() / places.len() as f64;
                WallPlane::HalfSpace { normal, offset }
            })
        };
        let walls = self.cell_faces(cell).iter().filter_map(wall).collect();
        if is_plane { Domain::polygon(walls) } else { Domain::polyhedron(walls) }
    }
}
