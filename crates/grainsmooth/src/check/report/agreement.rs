//! How a network agrees with the map that it should show.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::num::NonZeroU32;

use glam::DVec3;
use polycrystal::{BoundaryDistances, BoundaryId, GrainId, Side, Surface};
use rayon::prelude::*;
use serde::Serialize;
use voronoi::{Dimension, Domain};

use crate::figures::significant::significant;
use crate::{LabelGrid, LabelMap, LabelledFile, MapProblem, MeasuredMap};

/// How far the box around the grains of a network may be from that around the grains of a map for both to be in one place, in voxels: smooth surfaces are flatter than voxels,
/// and programs put the first voxel at its middle or at its corner.
const APART: f64 = 2.0;

/// How a network agrees with a map of labels. Its text is for people; serialized it is for programs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MapAgreement {
    /// Number of voxels of the map (in the plane: of pixels).
    pub voxels: u64,
    /// Voxels whose centre lies in another grain than their label says.
    pub differing_voxels: u64,
    /// Difference between the volume of a grain (in the plane: its area) and that of its voxels, as a share of this: the mean of all grains.
    pub mean_volume_error: f64,
    /// The largest of them.
    pub largest_volume_error: f64,
    /// How far the middle of a face between voxels of two grains (in the plane: an edge of pixels) is from the boundary of these grains, in voxels: the mean.
    pub mean_distance: f64,
    /// The largest of them.
    pub largest_distance: f64,
    /// Pairs of grains that touch in the map by faces of voxels.
    pub neighbors: usize,
    /// Those of them that have no boundary in the network.
    pub lost_neighbors: usize,
    /// Pairs of grains that have a boundary in the network only.
    pub new_neighbors: usize,
    /// What was found of each grain of the map.
    pub grains: Vec<GrainAgreement>,
}

/// How a grain of a network agrees with the voxels of its label.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GrainAgreement {
    /// Its label in the map.
    pub label: u32,
    /// Its number in the network; nothing where the network has no such grain.
    pub grain: Option<u32>,
    /// Its voxels in the map.
    pub voxels: u64,
    /// Those of them whose centre lies elsewhere in the network.
    pub differing_voxels: u64,
    /// Its volume in the network (in the plane: its area).
    pub volume: f64,
    /// The volume of its voxels.
    pub voxel_volume: f64,
}

impl MapAgreement {
    /// Compares a network, whose grains have these volumes, with a map. A label of the map stands for the grain that was smoothed from it, or else for the grain of that number.
    ///
    /// # Errors
    /// [`MapProblem::Elsewhere`] where the map and the network do not fill the same place.
    pub fn new(
        name: &str,
        file: &LabelledFile,
        volumes: &[(GrainId, f64)],
        measured: &MeasuredMap,
    ) -> Result<Self, MapProblem> {
        let points: Vec<DVec3> = file.points.iter().map(|point| *point * file.stretch).collect();
        let surface = Surface { points: &points, ..file.surface() };
        let map = &measured.map;
        if map.periodic.any() && !repeats_as(file, map) {
            return Err(MapProblem::Unfit {
                what: "is taken to repeat, and the network does not so",
                remedy: "leave --periodic out, or give the axes with which the network was made",
            });
        }
        let domain = domain_at(name, &surface, map)?;
        let numbers = surface.grains();
        // With settings they are numbers of seeds.
        let map_labels = file.seed_ids.as_ref().filter(|_| file.settings.is_none());
        let by_label: BTreeMap<(u32, u32), GrainId> = match map_labels {
            Some(labels) => numbered_parts(labels.iter().map(|(grain, label)| (*label, *grain))).collect(),
            None => numbers.into_iter().map(|grain| ((grain.0, 0), grain)).collect(),
        };
        let labels = measured.labels.iter().map(|label| (*label, ()));
        let grains: Vec<Option<GrainId>> =
            numbered_parts(labels).map(|(label, ())| by_label.get(&label).copied()).collect();
        let sides = Sides { of_grains: &grains };

        let mut counts = vec![0; grains.len()];
        let mut differing = vec![0; grains.len()];
        let mut differing_voxels = 0;
        let size = map.shape.map(|count| {
            let count = u32::try_from(count).expect("an axis of a map has fewer than 2^32 voxels");
            NonZeroU32::new(count).expect("a map has voxels")
        });
        let grid = LabelGrid::of_surface(&domain, &surface, size);
        let found = (0..grid.slab_count()).flat_map(|slab| grid.slab(slab));
        for (label, found) in map.labels.iter().zip(found) {
            let differs = sides.of(*label) != Some(found);
            differing_voxels += u64::from(differs);
            if let Ok(grain) = usize::try_from(*label) {
                counts[grain] += 1;
                differing[grain] += u64::from(differs);
            }
        }

        let voxel =
            if map.is_plane() { map.spacing.x * map.spacing.y } else { map.spacing.element_product() };
        let volumes: BTreeMap<GrainId, f64> = volumes.iter().copied().collect();
        let stretch = file.stretch.element_product();
        let of_grain = |index: usize| GrainAgreement {
            label: measured.labels[index],
            grain: grains[index].map(|grain| grain.0),
            voxels: counts[index],
            differing_voxels: differing[index],
            volume: grains[index]
                .and_then(|grain| volumes.get(&grain))
                .map_or(0.0, |volume| volume * stretch),
            voxel_volume: counts[index] as f64 * voxel,
        };
        let of_grains: Vec<GrainAgreement> = (0..grains.len()).map(of_grain).collect();
        let errors = of_grains.iter().map(|grain| (grain.volume / grain.voxel_volume - 1.0).abs());
        let (volume_error_sum, largest_volume_error) = sum_and_largest(errors);

        let (boundary_of, across) = across_periods(&surface, file.originals.as_deref());
        let surface = Surface { boundary_of: &boundary_of, sides: &across, ..surface };
        let Faces { distances, pairs, lost_neighbors, new_neighbors } = Faces::new(&surface, map, &sides);
        let (distance_sum, largest_distance) = sum_and_largest(distances.iter().copied());
        let mean = |sum: f64, count: usize| if count > 0 { sum / count as f64 } else { 0.0 };
        Ok(Self {
            voxels: map.labels.len() as u64,
            differing_voxels,
            mean_volume_error: mean(volume_error_sum, of_grains.len()),
            largest_volume_error,
            mean_distance: mean(distance_sum, distances.len()),
            largest_distance,
            neighbors: pairs,
            lost_neighbors,
            new_neighbors,
            grains: of_grains,
        })
    }
}

/// Labels with the number of times that each came before: parts of one label have the same order in a map and in its network.
fn numbered_parts<T>(labels: impl Iterator<Item = (u32, T)>) -> impl Iterator<Item = ((u32, u32), T)> {
    let mut seen: BTreeMap<u32, u32> = BTreeMap::new();
    labels.map(move |(label, of)| {
        let before = seen.entry(label).or_default();
        *before += 1;
        ((label, *before - 1), of)
    })
}

/// What the labels of a map are in a network.
struct Sides<'a> {
    of_grains: &'a [Option<GrainId>],
}

impl Sides<'_> {
    /// Nothing where the network has no such grain.
    fn of(&self, label: i32) -> Option<Side> {
        match usize::try_from(label) {
            Ok(grain) => self.of_grains[grain].map(Side::Grain),
            Err(_) => Some(Side::Exterior),
        }
    }
}

/// The faces between voxels of two labels, beside the boundaries of a network.
struct Faces {
    /// Of the middle of each face from the boundary between its sides, in voxels.
    distances: Vec<f64>,
    /// Pairs of grains that touch.
    pairs: usize,
    lost_neighbors: usize,
    new_neighbors: usize,
}

impl Faces {
    fn new(surface: &Surface<'_>, map: &LabelMap, sides: &Sides<'_>) -> Self {
        let [nx, ny, nz] = map.shape;
        // In the plane nothing has a height.
        let in_voxels = |point: &DVec3| (*point - map.origin) / map.spacing;
        let points: Vec<DVec3> = surface.points.iter().map(in_voxels).collect();
        let surface = Surface { points: &points, ..*surface };
        let boundaries = BoundaryDistances::new(&surface);
        let height = if map.is_plane() { in_voxels(&DVec3::ZERO).z - 0.5 } else { 0.0 };
        let copies = copies_in_voxels(map);
        let of_row = |row: usize| {
            let (y, z) = (row % ny, row / ny);
            let mut distances = Vec::new();
            let mut pairs = BTreeSet::new();
            for x in 0..nx {
                let voxel = row * nx + x;
                let middle = DVec3::new(x as f64 + 0.5, y as f64 + 0.5, z as f64 + 0.5 + height);
                for (axis, (at, step)) in [(x, 1), (y, nx), (z, nx * ny)].into_iter().enumerate() {
                    let next = match map.shape[axis] {
                        count if at + 1 < count => voxel + step,
                        // What repeats goes on with its first voxel.
                        count if map.periodic.test(axis) => voxel - step * (count - 1),
                        _ => continue,
                    };
                    let labels = [map.labels[voxel], map.labels[next]];
                    if labels[0] == labels[1] {
                        continue;
                    }
                    if let [Some(one), Some(other)] = labels.map(|label| sides.of(label)) {
                        let face = middle + 0.5 * DVec3::AXES[axis];
                        let to_copies =
                            copies.iter().filter_map(|copy| boundaries.distance([one, other], face + *copy));
                        distances.extend(to_copies.min_by(f64::total_cmp));
                    }
                    if labels[0] >= 0 && labels[1] >= 0 {
                        pairs.insert([labels[0].min(labels[1]), labels[0].max(labels[1])]);
                    }
                }
            }
            (distances, pairs)
        };
        let of_rows: Vec<(Vec<f64>, BTreeSet<[i32; 2]>)> = (0..ny * nz).into_par_iter().map(of_row).collect();
        let mut distances = Vec::new();
        let mut pairs = BTreeSet::new();
        for (of_row, pairs_of_row) in of_rows {
            distances.extend(of_row);
            pairs.extend(pairs_of_row);
        }
        let sides_of = |pair: &[i32; 2]| {
            let [one, other] = pair.map(|label| sides.of(label));
            let mut sides = [one?, other?];
            sides.sort_unstable();
            Some(sides)
        };
        let in_map: BTreeSet<[Side; 2]> = pairs.iter().filter_map(sides_of).collect();
        let is_inside = |sides: &[Side; 2]| !sides.contains(&Side::Exterior);
        let in_network: BTreeSet<[Side; 2]> = boundaries.pairs().filter(is_inside).collect();
        Self {
            distances,
            pairs: pairs.len(),
            lost_neighbors: pairs.len() - in_map.intersection(&in_network).count(),
            new_neighbors: in_network.difference(&in_map).count(),
        }
    }
}

/// Whether a network has the periods of a map.
fn repeats_as(file: &LabelledFile, map: &LabelMap) -> bool {
    let Some(periods) = file.periods.filter(|_| file.originals.is_some()) else { return false };
    let size = map.spacing * DVec3::from_array(map.shape.map(|count| count as f64));
    (0..3).all(|axis| {
        let period = if map.periodic.test(axis) { size[axis] } else { 0.0 };
        // Files in single precision round what they tell.
        (periods[axis] * file.stretch[axis] - period).abs() <= APART * map.spacing[axis]
    })
}

/// How far the copies of a point are from it, in voxels: those one period away, and itself.
fn copies_in_voxels(map: &LabelMap) -> Vec<DVec3> {
    let mut copies = vec![DVec3::ZERO];
    for axis in (0..3).filter(|axis| map.periodic.test(*axis)) {
        let period = map.shape[axis] as f64 * DVec3::AXES[axis];
        copies = copies.iter().flat_map(|copy| [*copy, *copy - period, *copy + period]).collect();
    }
    copies
}

/// The boundary of each element and the sides of all boundaries, with the grain beyond where an element comes again a period away.
fn across_periods(surface: &Surface<'_>, originals: Option<&[u32]>) -> (Vec<BoundaryId>, Vec<[Side; 2]>) {
    let Some(originals) = originals else { return (surface.boundary_of.to_vec(), surface.sides.to_vec()) };
    let elements = 0..u32::try_from(surface.elements.len()).expect("elements are numbered by u32");
    let outer = |element: &u32| surface.sides_of(*element).contains(&Side::Exterior);
    let mut copies: BTreeMap<Vec<u32>, Vec<u32>> = BTreeMap::new();
    for element in elements.clone().filter(outer) {
        let corners = surface.elements.corners(element);
        let mut corners: Vec<u32> = corners.iter().map(|corner| originals[*corner as usize]).collect();
        corners.sort_unstable();
        copies.entry(corners).or_default().push(element);
    }
    let inner = |element: u32| {
        surface.sides_of(element).into_iter().find(|side| *side != Side::Exterior).unwrap_or(Side::Exterior)
    };
    let pairs = copies.values().filter_map(|copies| <[u32; 2]>::try_from(copies.as_slice()).ok());
    let beyond: BTreeMap<u32, [Side; 2]> =
        pairs.flat_map(|[one, two]| [one, two].map(|copy| (copy, [inner(one), inner(two)]))).collect();
    let mut numbers: BTreeMap<[Side; 2], BoundaryId> = BTreeMap::new();
    let mut sides = Vec::new();
    let boundary_of = elements.map(|element| {
        let between = beyond.get(&element).copied().unwrap_or_else(|| surface.sides_of(element));
        let next = BoundaryId(u32::try_from(sides.len()).expect("no more boundaries than elements"));
        *numbers.entry(between).or_insert_with(|| {
            sides.push(between);
            next
        })
    });
    (boundary_of.collect(), sides)
}

/// The box that a map fills, if its grains are where those of the network are.
fn domain_at(name: &str, surface: &Surface<'_>, map: &LabelMap) -> Result<Domain, MapProblem> {
    let of_map = map.grain_bounds();
    let around = |bounds: [DVec3; 2], point: &DVec3| [bounds[0].min(*point), bounds[1].max(*point)];
    let of_network = surface.points.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], around);
    let axes = usize::from(surface.elements.dimension().axes());
    let apart = [0, 1].map(|end| ((of_map[end] - of_network[end]) / map.spacing).abs());
    // Whole grains go on through the sides of a box that repeats.
    let is_near = |axis: usize| map.periodic.test(axis) || apart.iter().all(|apart| apart[axis] <= APART);
    let is_plane = surface.elements.dimension() == Dimension::Two;
    let domain = map.domain().ok().filter(|_| map.is_plane() == is_plane && (0..axes).all(is_near));
    domain.ok_or_else(|| {
        let map_axes = if map.is_plane() { 2 } else { 3 };
        MapProblem::Elsewhere {
            place: in_words(of_map, map_axes),
            network: name.to_owned(),
            other: in_words(of_network, axes),
        }
    })
}

fn in_words([lower, upper]: [DVec3; 2], axes: usize) -> String {
    let of_axis = |axis| format!("[{}, {}]", significant(lower[axis], 4), significant(upper[axis], 4));
    (0..axes).map(of_axis).collect::<Vec<_>>().join(" x ")
}

fn sum_and_largest(numbers: impl Iterator<Item = f64>) -> (f64, f64) {
    numbers.fold((0.0, 0.0), |(sum, largest), number| (sum + number, number.max(largest)))
}

impl fmt::Display for MapAgreement {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { voxels, differing_voxels, .. } = self;
        match differing_voxels {
            0 => write!(
                out,
                "  labels      the centres of all {voxels} voxels lie in the grains of their labels"
            )?,
            _ => {
                let share = *differing_voxels as f64 / *voxels as f64;
                write!(
                    out,
                    "  labels      {differing_voxels} of {voxels} voxels lie in another grain than their labels say, {:.0} in a million",
                    1e6 * share
                )?;
            }
        }
        write!(
            out,
            "\n              volumes are off those of the voxels by {:.1e} of them in the mean, at most by {:.1e}",
            self.mean_volume_error, self.largest_volume_error
        )?;
        write!(
            out,
            "\n              boundaries are {:.3} voxels from the faces of voxels in the mean, at most {:.3}",
            self.mean_distance, self.largest_distance
        )?;
        write!(
            out,
            "\n              {} of {} pairs of neighbours do not touch in the network; {} others do",
            self.lost_neighbors, self.neighbors, self.new_neighbors
        )
    }
}
