//! From the points of an orientation map to its grains.

use glam::{BVec3, DVec3};
use rayon::prelude::*;
use texture::{CrystalSymmetry, Orientation, mean_orientation};

use super::super::cleaning::{NO_GRAIN, clean};
use super::super::label_map::{LabelMap, MeasuredCrystals, MeasuredMap, PointCounts};
use super::super::neighbors::Grid;
use super::super::options::MapOptions;
use super::grid::PointGrid;
use super::segmentation::{Crystal, merged_twins, segmented};
use crate::error::map_file::MapProblem;
use crate::maps::orientation_map::{HeadGrid, MapPhase, MapPoint, PointList};

/// The grains of a map.
///
/// # Errors
/// [`MapProblem`] where points stand on no grid, the symmetry of a phase is not known, or no grain is left.
pub(in super::super) fn grains(list: &PointList, options: &MapOptions) -> Result<MeasuredMap, MapProblem> {
    let symmetries = symmetries(list, options)?;
    let ebsd = &options.ebsd;
    if ebsd.align && list.sections.is_empty() {
        return Err(MapProblem::Unfit {
            what: "is a single section",
            remedy: "leave --align out, or give a folder of sections",
        });
    }
    if ebsd.min_ci.is_some() && list.points.iter().all(|point| point.confidence.is_none()) {
        return Err(MapProblem::Unfit {
            what: "its points have no confidence index",
            remedy: "leave --min-ci out, or choose points by their band contrast with --min-iq",
        });
    }
    let unlisted = |point: &&MapPoint| point.phase.is_some_and(|phase| list.phase(phase).is_none());
    if let Some(MapPoint { line, phase: Some(phase), .. }) = list.points.iter().find(unlisted) {
        let what = format!(
            "the point has phase {phase}, which its head does not list; add that phase there, or correct the point"
        );
        return Err(MapProblem::Line { line: *line, what });
    }
    let is_sure = |point: &MapPoint| {
        ebsd.min_ci.is_none_or(|least| point.confidence.is_some_and(|confidence| confidence >= least))
            && ebsd.min_iq.is_none_or(|least| point.quality >= least)
    };
    let turned = |orientation: Orientation| match ebsd.rotate {
        Some(rotation) => orientation.turned(rotation.axis, rotation.angle),
        None => orientation,
    };
    let crystal = |point: &MapPoint| {
        let phase = list.phase(point.phase?)?;
        Some(Crystal { phase, orientation: turned(Orientation::from_euler_degrees(point.angles)) })
    };
    let aligned = ebsd.align.then(|| {
        let good = |point: &MapPoint| crystal(point).filter(|_| is_sure(point));
        list.points.par_iter().map(good).collect::<Vec<Option<Crystal>>>()
    });
    let whole =
        PointGrid::of_list(list, aligned.as_deref().map(|crystals| (crystals, symmetries.as_slice())))?;
    let contradicted = list.head.contradicted(&whole);
    let grid = match &options.crop {
        Some(crop) => whole.cropped(crop)?,
        None => whole,
    };
    let points = |place: &Option<u32>| place.map(|point| &list.points[point as usize]);
    let solved: Vec<Option<Crystal>> =
        grid.points.par_iter().map(|place| points(place).and_then(crystal)).collect();
    let is_good = |place: &Option<u32>| points(place).is_some_and(is_sure);
    let crystals: Vec<Option<Crystal>> =
        solved.par_iter().zip(&grid.points).map(|(found, place)| found.filter(|_| is_good(place))).collect();

    let parts = segmented(&crystals, grid.grid, &symmetries, ebsd.threshold());
    let parts = Parts::new(&parts, &crystals, &symmetries);
    let grain_of = match ebsd.merge_twins {
        None => (0..).take(parts.means.len()).collect(),
        Some(twin) => {
            let tolerance = ebsd.twin_tolerance();
            merged_twins(parts.labels, grid.grid, &parts.means, &symmetries, twin, tolerance)
        }
    };
    let mut labels: Vec<i32> = parts.labels.iter().map(|part| of(&grain_of, *part)).collect();
    let grain_count = grain_of.iter().max().map_or(0, |last| last.cast_unsigned() as usize + 1);

    let exists: Vec<bool> = (0..labels.len()).into_par_iter().map(|place| grid.grid.exists(place)).collect();
    let mut is_hole: Vec<bool> =
        crystals.iter().zip(&exists).map(|(crystal, exists)| crystal.is_none() && *exists).collect();
    let pores = leave_pores_open(&mut is_hole, grid.grid, ebsd.min_pore);
    let cleaned = clean(&mut labels, is_hole, grid.grid, options.min_voxels)?;

    let largest = parts.largest_of(&grain_of, grain_count);
    let kept = cleaned.kept.iter().map(|label| largest[label.cast_unsigned() as usize]);
    let kept: Vec<usize> = kept.collect();
    let count = |is: &dyn Fn(usize) -> bool| (0..labels.len()).filter(|place| is(*place)).count() as u64;
    let counts = PointCounts {
        shape: [grid.columns, grid.rows, grid.sections],
        shifted: grid.shifted,
        is_hexagonal: matches!(grid.grid, Grid::Hexagons(_)),
        step: grid.step[0],
        unsolved: count(&|place| exists[place] && solved[place].is_none()),
        masked: count(&|place| solved[place].is_some() && crystals[place].is_none()),
        pores,
        grains: grain_count as u64,
        merged: (grain_of.len() - grain_count) as u64,
        contradicted,
    };
    let phases = list.phases.iter().map(|phase| phase.name.clone()).zip(symmetries);
    Ok(MeasuredMap {
        map: label_map(&grid, &labels, options),
        labels: cleaned.kept.iter().map(|label| label.cast_unsigned()).collect(),
        voxel_counts: cleaned.counts,
        dropped: cleaned.dropped,
        crystals: Some(MeasuredCrystals {
            phases: phases.collect(),
            phase_of: kept.iter().map(|part| parts.means[*part].phase).collect(),
            orientations: kept.iter().map(|part| parts.means[*part].orientation).collect(),
            spreads: kept.iter().map(|part| parts.spreads[*part]).collect(),
            points: counts,
        }),
    })
}

/// The symmetry of each phase, all known.
fn symmetries(list: &PointList, options: &MapOptions) -> Result<Vec<CrystalSymmetry>, MapProblem> {
    let given = options.ebsd.crystal_symmetry;
    let symmetry = |phase: &MapPhase| {
        phase.symmetry.or(given).ok_or_else(|| MapProblem::NoSymmetry { phase: phase.name.clone() })
    };
    list.phases.iter().map(symmetry).collect()
}

/// Connected points of one orientation, before twins are merged.
struct Parts<'a> {
    labels: &'a [i32],
    /// The mean of each part, and how far its points are from it, in degrees.
    means: Vec<Crystal>,
    spreads: Vec<f64>,
    counts: Vec<usize>,
}

impl<'a> Parts<'a> {
    fn new(labels: &'a [i32], crystals: &[Option<Crystal>], symmetries: &[CrystalSymmetry]) -> Self {
        let mut members: Vec<(i32, Crystal)> = labels
            .par_iter()
            .zip(crystals)
            .filter_map(|(label, crystal)| Some((*label, (*crystal)?)))
            .collect();
        // Stable, so that the first point of a part stays the first.
        members.par_sort_by_key(|(label, _)| *label);
        let parts: Vec<&[(i32, Crystal)]> = members.chunk_by(|a, b| a.0 == b.0).collect();
        let of_part = |part: &&[(i32, Crystal)]| {
            let phase = part[0].1.phase;
            let points: Vec<(Orientation, f64)> =
                part.iter().map(|(_, crystal)| (crystal.orientation, 1.0)).collect();
            let orientation = mean_orientation(&points, symmetries[phase]).expect("all weights are 1");
            let angle =
                |(point, _): &(Orientation, f64)| symmetries[phase].disorientation_angle(orientation, *point);
            let spread = points.iter().map(angle).sum::<f64>() / points.len() as f64;
            (Crystal { phase, orientation }, spread, points.len())
        };
        let found: Vec<(Crystal, f64, usize)> = parts.par_iter().map(of_part).collect();
        Self {
            labels,
            means: found.iter().map(|part| part.0).collect(),
            spreads: found.iter().map(|part| part.1).collect(),
            counts: found.iter().map(|part| part.2).collect(),
        }
    }

    /// The largest part of each grain, the first of equals.
    fn largest_of(&self, grain_of: &[i32], grains: usize) -> Vec<usize> {
        let mut largest: Vec<Option<usize>> = vec![None; grains];
        for (part, grain) in grain_of.iter().enumerate() {
            let known = &mut largest[grain.cast_unsigned() as usize];
            if known.is_none_or(|known| self.counts[known] < self.counts[part]) {
                *known = Some(part);
            }
        }
        largest.into_iter().flatten().collect()
    }
}

/// The grain of a part.
fn of(grain_of: &[i32], part: i32) -> i32 {
    usize::try_from(part).map_or(NO_GRAIN, |part| grain_of[part])
}

/// Takes holes of so many places or more out of those to fill, and returns their places.
fn leave_pores_open(is_hole: &mut [bool], grid: Grid, least: Option<u64>) -> u64 {
    let Some(least) = least else { return 0 };
    let mut open = 0;
    let mut is_seen = vec![false; is_hole.len()];
    for start in 0..is_hole.len() {
        if !is_hole[start] || is_seen[start] {
            continue;
        }
        is_seen[start] = true;
        let mut places = vec![start];
        let mut next = 0;
        while let Some(place) = places.get(next).copied() {
            next += 1;
            for other in grid.neighbors(place) {
                if is_hole[other] && !std::mem::replace(&mut is_seen[other], true) {
                    places.push(other);
                }
            }
        }
        if places.len() as u64 >= least {
            open += places.len() as u64;
            places.iter().for_each(|place| is_hole[*place] = false);
        }
    }
    open
}

/// Pixels or voxels of grains, with the first row and the first section of the map on top. Each point of a hexagonal grid has two, so that pixels touch as hexagons do.
fn label_map(grid: &PointGrid, labels: &[i32], options: &MapOptions) -> LabelMap {
    let from_top = grid.mirror - (grid.first[1] + grid.step[1] * (grid.rows - 1) as f64);
    // Depth grows from section to section as y does from row to row.
    let rows =
        || (0..grid.sections).rev().flat_map(|at| (0..grid.rows).rev().map(move |row| at * grid.rows + row));
    let (nx, labels, width, left) = match grid.grid {
        Grid::Voxels(..) => {
            let row = |row: usize| labels[row * grid.columns..(row + 1) * grid.columns].iter().copied();
            (grid.columns, rows().flat_map(row).collect(), grid.step[0], 0.5 * grid.step[0])
        }
        Grid::Hexagons(hexagons) => {
            let nx = (hexagons.half_columns - 1).max(1);
            let row = |row: usize| (0..nx).map(move |half| labels[hexagons.at(half, row)]);
            (nx, rows().flat_map(row).collect(), 0.5 * grid.step[0], 0.0)
        }
    };
    let found = DVec3::new(width, grid.step[1], grid.thickness.unwrap_or(width));
    let spacing = options.spacing().unwrap_or(found);
    let lower = DVec3::new(grid.first[0] - left, from_top - 0.5 * grid.step[1], 0.0);
    LabelMap {
        shape: [nx, grid.rows, grid.sections],
        spacing,
        origin: lower * (spacing / found),
        periodic: BVec3::FALSE,
        labels,
    }
}

impl HeadGrid {
    /// What the points of a map do not agree with, in words.
    fn contradicted(&self, grid: &PointGrid) -> Option<String> {
        let Self { columns, rows, step } = *self;
        let counts = columns.zip(rows).filter(|told| *told != (grid.columns, grid.rows));
        let step = step.filter(|step| (step - grid.step[0]).abs() > 0.01 * grid.step[0]);
        match (counts, step) {
            (None, None) => None,
            (Some((columns, rows)), None) => Some(format!("{columns} x {rows} points")),
            (None, Some(step)) => Some(format!("step {step}")),
            (Some((columns, rows)), Some(step)) => Some(format!("{columns} x {rows} points, step {step}")),
        }
    }
}
