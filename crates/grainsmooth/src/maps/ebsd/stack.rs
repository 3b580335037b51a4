//! Sections of a sample, one above the other, as one grid.

use std::ops::Range;

use glam::{BVec3, IVec2};
use rayon::prelude::*;
use texture::CrystalSymmetry;

use super::super::neighbors::Grid;
use super::grid::PointGrid;
use super::segmentation::Crystal;
use crate::error::map_file::MapProblem;
use crate::maps::orientation_map::PointList;

/// Degrees by which crystals above one another may differ and count as one, as in DREAM.3D.
const SAME_CRYSTAL: f64 = 5.0;

/// How far a shift is looked for around the best one so far, in points along each axis, as in DREAM.3D.
const WINDOW: i32 = 3;

/// Points of a section that are compared for each shift: more tell no other shift, and cost time.
const COMPARED: usize = 10_000;

impl PointGrid {
    /// The grid of all sections of a list. `align` has what crystal each point has, and their symmetries: sections are shifted so that those above one another agree best, and what is
    /// not in all of them is left out.
    ///
    /// # Errors
    /// As of [`PointGrid::new`], with the section; where sections differ in size, are hexagonal, or have no place in common.
    pub(super) fn of_list(
        list: &PointList,
        align: Option<(&[Option<Crystal>], &[CrystalSymmetry])>,
    ) -> Result<Self, MapProblem> {
        if list.sections.is_empty() {
            return Self::new(&list.points);
        }
        let mut sections: Vec<Self> = Vec::with_capacity(list.sections.len());
        let mut start = 0;
        for section in &list.sections {
            let of_section =
                |problem| MapProblem::Slice { name: section.name.clone(), problem: Box::new(problem) };
            let end = start + section.points;
            let mut grid = Self::new(&list.points[start..end]).map_err(of_section)?;
            if matches!(grid.grid, Grid::Hexagons(_)) {
                return Err(of_section(MapProblem::Unfit {
                    what: "is a hexagonal grid, and sections are stacked on square ones",
                    remedy: "convert it to a square grid",
                }));
            }
            if let Some(first) = sections.first().filter(|first| first.size() != grid.size()) {
                let [size, first] = [grid.size(), first.size()];
                return Err(MapProblem::SliceSize { name: section.name.clone(), size, first });
            }
            let before = u32::try_from(start).expect("points are numbered by u32");
            grid.points.iter_mut().flatten().for_each(|point| *point += before);
            sections.push(grid);
            start = end;
        }
        let shifts = match align {
            Some((crystals, symmetries)) => shifts(&sections, crystals, symmetries),
            None => vec![IVec2::ZERO; sections.len()],
        };
        stacked(&sections, &shifts, list.thickness)
    }

    fn size(&self) -> [usize; 2] {
        [self.columns, self.rows]
    }

    /// The point of a section at a place, if there is one.
    fn point(&self, at: IVec2) -> Option<u32> {
        let column = usize::try_from(at.x).ok().filter(|column| *column < self.columns)?;
        let row = usize::try_from(at.y).ok().filter(|row| *row < self.rows)?;
        self.points[row * self.columns + column]
    }
}

/// How many points each section is shifted against the first: what the first has at a place, another has so much further.
fn shifts(
    sections: &[PointGrid],
    crystals: &[Option<Crystal>],
    symmetries: &[CrystalSymmetry],
) -> Vec<IVec2> {
    let between: Vec<IVec2> =
        sections.par_windows(2).map(|pair| shift(&pair[0], &pair[1], crystals, symmetries)).collect();
    let mut sum = IVec2::ZERO;
    let later = between.into_iter().map(|shift| {
        sum += shift;
        sum
    });
    std::iter::once(IVec2::ZERO).chain(later).collect()
}

/// The shift of a section against the one before at which most crystals are those there: looked for around the best one, until none near it is better.
fn shift(
    before: &PointGrid,
    section: &PointGrid,
    crystals: &[Option<Crystal>],
    symmetries: &[CrystalSymmetry],
) -> IVec2 {
    let [columns, rows] = section.size().map(|count| i32::try_from(count).unwrap_or(i32::MAX));
    let stride = (1..).find(|stride: &usize| section.points.len() / (stride * stride) <= COMPARED);
    let stride = stride.expect("some number is large enough");
    let crystal = |point: Option<u32>| point.and_then(|point| crystals[point as usize].as_ref());
    // The share of points that differ from what lies there before.
    let differing = |shift: IVec2| {
        let (mut count, mut differing) = (0_u32, 0_u32);
        for y in (0..rows).step_by(stride) {
            for x in (0..columns).step_by(stride) {
                let at = IVec2::new(x, y);
                let [one, two] = [before.point(at), section.point(at + shift)];
                if one.is_none() || two.is_none() {
                    continue;
                }
                count += 1;
                let is_one = match (crystal(one), crystal(two)) {
                    (Some(one), Some(two)) => {
                        let symmetry = symmetries[one.phase];
                        one.phase == two.phase
                            && symmetry.disorientation_angle(one.orientation, two.orientation) <= SAME_CRYSTAL
                    }
                    (None, None) => true,
                    _ => false,
                };
                differing += u32::from(!is_one);
            }
        }
        if count == 0 { 1.0 } else { f64::from(differing) / f64::from(count) }
    };
    // Shifts of more than half a section leave too little to compare.
    let most = IVec2::new(columns, rows) / 2;
    let (mut best, mut least) = (IVec2::ZERO, differing(IVec2::ZERO));
    loop {
        let center = best;
        for y in -WINDOW..=WINDOW {
            for x in -WINDOW..=WINDOW {
                let tried = center + IVec2::new(x, y);
                if tried == center || tried.abs().cmpgt(most).any() {
                    continue;
                }
                let found = differing(tried);
                let is_nearer = found == least && tried.length_squared() < best.length_squared();
                if found < least || is_nearer {
                    (best, least) = (tried, found);
                }
            }
        }
        if best == center {
            return best;
        }
    }
}

/// What all sections have in common after their shifts.
fn stacked(
    sections: &[PointGrid],
    shifts: &[IVec2],
    thickness: Option<f64>,
) -> Result<PointGrid, MapProblem> {
    let first = sections.first().ok_or(MapProblem::NoLabels)?;
    let common = |axis: usize| -> Range<i32> {
        let count = i32::try_from(first.size()[axis]).unwrap_or(i32::MAX);
        let start = shifts.iter().map(|shift| -shift[axis]).max().unwrap_or(0);
        let end = shifts.iter().map(|shift| count - shift[axis]).min().unwrap_or(count);
        start..end
    };
    let [columns, rows] = [common(0), common(1)];
    if columns.is_empty() || rows.is_empty() {
        return Err(MapProblem::Unfit {
            what: "has sections that share no place after they are aligned",
            remedy: "leave --align out, or align them with another program",
        });
    }
    let mut points = Vec::with_capacity(sections.len() * columns.len() * rows.len());
    for (section, shift) in sections.iter().zip(shifts) {
        for y in rows.clone() {
            points.extend(columns.clone().map(|x| section.point(IVec2::new(x, y) + shift)));
        }
    }
    let [x, y] = first.first;
    let first_place =
        [x + f64::from(columns.start) * first.step[0], y + f64::from(rows.start) * first.step[1]];
    Ok(PointGrid {
        grid: Grid::Voxels([columns.len(), rows.len(), sections.len()], BVec3::FALSE),
        columns: columns.len(),
        rows: rows.len(),
        sections: sections.len(),
        thickness,
        shifted: shifts.iter().filter(|shift| **shift != IVec2::ZERO).count(),
        first: first_place,
        points,
        ..*first
    })
}
