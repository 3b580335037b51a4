//! What is said of a measured map.

use std::fmt;

use crate::figures::counted::Counted;
use crate::{CellFit, Measurement, SmoothedMap};

/// Degrees of spread above which the points of a grain have hardly one orientation.
const LARGE_SPREAD: f64 = 5.0;

/// What the map was, and what was changed of it.
pub(super) fn write_map(out: &mut fmt::Formatter<'_>, map: &SmoothedMap) -> fmt::Result {
    let SmoothedMap { shape: [nx, ny, nz], dropped: [grains, voxels], relabelled, points, fit, .. } = map;
    match (points, nz) {
        (Some(points), _) => write!(out, "map         {points}")?,
        (None, 1) => write!(out, "map         {nx} x {ny} pixels")?,
        (None, _) => write!(out, "map         {nx} x {ny} x {nz} voxels")?,
    }
    if *grains > 0 {
        let grains = Counted(usize::try_from(*grains).unwrap_or(usize::MAX), "small grain");
        write!(out, "; {voxels} in {grains} went to neighbours")?;
    }
    if *relabelled > 0 {
        write!(out, "; {relabelled} got another label where a grain touched itself")?;
    }
    writeln!(out)?;
    let Some(CellFit { agreeing_voxels, voxels, centroid_distance }) = fit else { return Ok(()) };
    writeln!(
        out,
        "cells       {:.2} % of the voxels lie in the cell of their label; centroids are {centroid_distance:.3} grain widths apart",
        100.0 * *agreeing_voxels as f64 / *voxels as f64
    )
}

/// The phases of measured grains, and how far their points are spread around their mean orientations.
pub(super) fn write_crystals(
    out: &mut fmt::Formatter<'_>,
    Measurement { grains, .. }: &Measurement,
) -> fmt::Result {
    let Some((phases, measured)) = grains.phases.as_ref().zip(grains.measured.as_ref()) else {
        return Ok(());
    };
    let volumes: Vec<f64> = measured.voxel_counts.iter().map(|count| *count as f64).collect();
    for share in phases.shares(&volumes, &volumes).iter().filter(|share| share.grains > 0) {
        writeln!(out, "phase {:<6}{share}", share.number)?;
    }
    let Some(spreads) = &measured.spreads else { return Ok(()) };
    let mean = spreads.iter().zip(&volumes).map(|(spread, volume)| spread * volume).sum::<f64>()
        / volumes.iter().sum::<f64>();
    let largest = spreads.iter().copied().fold(0.0, f64::max);
    let drifting = spreads.iter().filter(|spread| **spread > LARGE_SPREAD).count();
    write!(out, "spread      {mean:.2} degrees from the mean orientation (GOS), at most {largest:.2}")?;
    match drifting {
        0 => writeln!(out),
        _ => writeln!(
            out,
            "; {} above {LARGE_SPREAD}, where small steps add up; a lower --threshold may separate them",
            Counted(drifting, "grain")
        ),
    }
}
