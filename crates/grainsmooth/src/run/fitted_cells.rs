//! A power diagram fitted to a map: convex cells with the volumes and, as far as these go together, the centroids of measured grains.
//!
//! Volumes and centroids of the cells determine a power diagram, and where the grains come from one, it is this one. Seeds are the maximum of a concave function whose
//! slope is what centroids miss, times the volume (Bourne, Pearce and Roper, Inverting Laguerre tessellations, 2024, arXiv:2406.00871).

use std::f64::consts::TAU;
use std::path::Path;

use glam::DVec3;
use polycrystal::{Junctions, Network};
use rayon::prelude::*;
use serde::Serialize;
use voronoi::volumes::{PowerDiagram, VolumesError};
use voronoi::{CellId, Domain};

use crate::Error;
use crate::error::map_file::MapProblem;
use crate::maps::label_map::{LabelMap, MeasuredMap};

/// Diagrams that are tried. They left centroids 0.001 grain widths off for 50 grains in 48^3 voxels, flat ones and ones at rest, and 0.004 for 200 of random seeds in 64^3.
const ROUNDS: usize = 30;

/// The shortest step of seeds, as a share of what centroids miss, below which nothing is gained.
const LEAST_STEP: f64 = 0.05;

/// How cells that were fitted to a map agree with it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CellFit {
    /// Voxels (in the plane: pixels) whose middle lies in the cell of their label.
    pub agreeing_voxels: u64,
    /// All voxels.
    pub voxels: u64,
    /// How far centroids of cells are from those of their grains, in edges of a cube as large as the mean grain: the root of the mean square, by volume.
    pub centroid_distance: f64,
}

/// The flat network of fitted cells.
pub(super) struct FittedCells {
    pub(super) network: Network,
    pub(super) points: Vec<DVec3>,
    pub(super) fit: CellFit,
}

/// The cells, one for each grain of a map.
///
/// # Errors
/// [`Error::MapFile`] where the map has pores, or there is no such diagram, as where grains have one centroid; [`Error::NetworkOfMap`].
pub(super) fn fitted_cells(path: &Path, measured: &MeasuredMap) -> Result<FittedCells, Error> {
    let unfit = |problem| Error::MapFile { path: path.to_owned(), problem };
    let map = &measured.map;
    let mut voxels = vec![0.0; measured.labels.len()];
    for label in &map.labels {
        let Ok(grain) = usize::try_from(*label) else {
            return Err(unfit(MapProblem::Unfit {
                what: "has voxels without a grain, and cells fill a box",
                remedy: "crop the map to its grains, or leave --fit-cells out",
            }));
        };
        voxels[grain] += 1.0;
    }
    let domain = map.domain()?;
    let voxel = domain.measure() / map.labels.len() as f64;
    let volumes: Vec<f64> = voxels.iter().map(|count| count * voxel).collect();
    let wanted = centroids(map, &domain, &voxels);
    let (diagram, missed) =
        fitted(&domain, &wanted, &volumes).map_err(|problem| unfit(MapProblem::NoCells(problem)))?;
    let failed = |cause| Error::NetworkOfMap { path: path.to_owned(), cause: Box::new(cause) };
    let tessellation = diagram.tessellation();
    let resolved = tessellation.resolved();
    let (network, points) =
        Network::new(resolved.as_ref().unwrap_or(tessellation), Junctions::Crease, 0).map_err(failed)?;
    let edge = domain.dimension().cube_edge(domain.measure() / volumes.len() as f64);
    let fit = CellFit {
        agreeing_voxels: agreeing_voxels(map, &domain, &diagram),
        voxels: map.labels.len() as u64,
        centroid_distance: (missed / domain.measure()).sqrt() / edge,
    };
    Ok(FittedCells { network, points, fit })
}

/// The centroids of all grains, of so many voxels each; where the map repeats, of whole grains.
fn centroids(map: &LabelMap, domain: &Domain, voxels: &[f64]) -> Vec<DVec3> {
    let grain = |label: &i32| usize::try_from(*label).expect("every voxel has a grain");
    let middles =
        || map.labels.iter().enumerate().map(|(voxel, label)| (grain(label), middle(map, place(map, voxel))));
    // On the circle that a period is, the mean direction is near the centroid of a grain narrower than half of it.
    let angles = |point: DVec3| TAU * (point - domain.lower()) / domain.size();
    let mut directions = vec![[DVec3::ZERO; 2]; voxels.len()];
    for (grain, point) in middles() {
        let angles = angles(point).to_array();
        directions[grain][0] += DVec3::from_array(angles.map(f64::cos));
        directions[grain][1] += DVec3::from_array(angles.map(f64::sin));
    }
    let about: Vec<DVec3> = directions
        .iter()
        .map(|[cosine, sine]| {
            let turns = [0, 1, 2].map(|axis| sine[axis].atan2(cosine[axis]) / TAU);
            let along = DVec3::from_array(turns) * domain.size();
            domain.lower() + DVec3::select(domain.periodic(), along, DVec3::ZERO)
        })
        .collect();
    let mut sums = vec![DVec3::ZERO; voxels.len()];
    for (grain, point) in middles() {
        sums[grain] += nearest_copy(domain, point - about[grain]);
    }
    let mean = |((sum, count), about): ((&DVec3, &f64), &DVec3)| inside(domain, *about + *sum / *count);
    sums.iter().zip(voxels).zip(&about).map(mean).collect()
}

/// The shortest of the vectors to all copies of a point.
fn nearest_copy(domain: &Domain, vector: DVec3) -> DVec3 {
    let periods = (vector / domain.size()).round();
    vector - DVec3::select(domain.periodic(), periods * domain.size(), DVec3::ZERO)
}

/// The copy of a point that lies in the box.
fn inside(domain: &Domain, point: DVec3) -> DVec3 {
    let periods = ((point - domain.lower()) / domain.size()).floor();
    point - DVec3::select(domain.periodic(), periods * domain.size(), DVec3::ZERO)
}

/// The diagram of these volumes whose centroids are nearest to those wanted, and the sum of squared distances times volumes.
fn fitted(domain: &Domain, wanted: &[DVec3], volumes: &[f64]) -> Result<(PowerDiagram, f64), VolumesError> {
    let misses = |diagram: &PowerDiagram| -> Vec<DVec3> {
        let cells = diagram.tessellation().cell_measures();
        wanted.iter().zip(cells).map(|(wanted, cell)| nearest_copy(domain, *wanted - cell.centroid)).collect()
    };
    let sum = |misses: &[DVec3]| -> f64 {
        misses.iter().zip(volumes).map(|(miss, volume)| miss.length_squared() * volume).sum()
    };
    let mut best = PowerDiagram::with_volumes(domain, wanted, volumes)?;
    let mut missed = misses(&best);
    let mut step = 1.0;
    for _ in 0..ROUNDS {
        let seeds = best.tessellation().seeds().iter().zip(&missed).map(|(seed, miss)| {
            let moved = inside(domain, *seed + step * *miss);
            if domain.contains(moved) { moved } else { *seed }
        });
        let tried = PowerDiagram::with_volumes(domain, &seeds.collect::<Vec<_>>(), volumes);
        // Seeds that come too near each other have no cells.
        match tried.map(|tried| (misses(&tried), tried)) {
            Ok((now, tried)) if sum(&now) < sum(&missed) => (best, missed) = (tried, now),
            _ => step /= 2.0,
        }
        if step < LEAST_STEP {
            break;
        }
    }
    let missed = sum(&missed);
    Ok((best, missed))
}

/// Number of voxels whose middle lies in the cell of their grain: nearer to it, by power distance, than to all neighbours of the cell.
fn agreeing_voxels(map: &LabelMap, domain: &Domain, diagram: &PowerDiagram) -> u64 {
    let tessellation = diagram.tessellation();
    let (seeds, weights) = (tessellation.seeds(), diagram.weights());
    let beside = |cell: CellId| {
        let sides = tessellation.cell_faces(cell).iter().flat_map(|face| tessellation.face_sides(*face));
        let cells = sides.filter_map(|side| side.cell());
        cells.map(|(cell, _)| cell.index()).filter(|other| *other != cell.index()).collect()
    };
    let neighbors: Vec<Vec<usize>> = (0u32..).map(CellId).take(seeds.len()).map(beside).collect();
    let agrees = |(voxel, label): (usize, &i32)| {
        let Ok(own) = usize::try_from(*label) else { return false };
        let middle = middle(map, place(map, voxel));
        let distance =
            |cell: usize| nearest_copy(domain, seeds[cell] - middle).length_squared() - weights[cell];
        neighbors[own].iter().all(|other| distance(own) <= distance(*other))
    };
    map.labels.par_iter().enumerate().filter(|voxel| agrees(*voxel)).count() as u64
}

/// The middle of a voxel, in voxels from the first corner.
fn place(map: &LabelMap, voxel: usize) -> DVec3 {
    let [nx, ny, _] = map.shape;
    DVec3::from_array([voxel % nx, voxel / nx % ny, voxel / (nx * ny)].map(|at| at as f64 + 0.5))
}

/// Where that is in the map.
fn middle(map: &LabelMap, place: DVec3) -> DVec3 {
    let middle = map.origin + place * map.spacing;
    if map.is_plane() { middle.with_z(0.0) } else { middle }
}
