//! Short edges that collapse in many slabs at once.

use glam::DVec3;
use rayon::prelude::*;
use voronoi::{Domain, PeriodicVertex, Side};

use crate::mesh::id::id;
use crate::network::coarsening::coarsened_around;

/// A surface cut into slabs across an axis.
pub(super) struct Slabs<'a> {
    pub(super) domain: &'a Domain,
    pub(super) points: &'a [DVec3],
    /// Of each point: edges at it that are shorter collapse.
    pub(super) limits: &'a [Option<f64>],
    pub(super) sides: &'a [[Side; 2]],
    pub(super) axis: usize,
    pub(super) thickness: f64,
}

type Corners = Option<[PeriodicVertex; 3]>;

/// Of a point: it is in no slab yet, or in several.
const NOWHERE: u32 = u32::MAX;
const SHARED: u32 = u32::MAX - 1;

impl Slabs<'_> {
    /// As [`coarsened`](crate::network::coarsening::coarsened) with other choices near the borders of slabs; the number of threads decides nothing.
    ///
    /// Points at borders stay at first. Then slabs begin half a thickness further up, and last come the points that stayed twice.
    pub(super) fn coarsened(&self, triangles: &[[PeriodicVertex; 3]]) -> Vec<Corners> {
        let mut left: Vec<Corners> = triangles.iter().copied().map(Some).collect();
        let mut marked = vec![true; self.points.len()];
        for begin in [0.0, 0.5] {
            self.coarsen_each(&mut left, &mut marked, begin);
        }
        coarsened_around(self.domain, self.points, self.limits, left, self.sides, &mut marked)
    }

    /// Coarsens each slab by itself. Points stay marked where something may be left to do.
    fn coarsen_each(&self, left: &mut [Corners], marked: &mut [bool], begin: f64) {
        let mut slabs: Vec<Vec<u32>> = Vec::new();
        let mut slab_of = vec![NOWHERE; self.points.len()];
        for (triangle, corners) in (0u32..).zip(left.iter()) {
            let Some(corners) = corners else { continue };
            let height = self.points[corners[0].vertex as usize][self.axis] / self.thickness + begin;
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "no larger than a map"
            )]
            let slab = height as usize;
            slabs.resize_with(slabs.len().max(slab + 1), Vec::new);
            slabs[slab].push(triangle);
            for corner in corners {
                let known = &mut slab_of[corner.vertex as usize];
                *known = if [NOWHERE, id(slab)].contains(known) { id(slab) } else { SHARED };
            }
        }
        let coarsened: Vec<Coarsened> =
            slabs.par_iter().map(|slab| self.coarsened_slab(slab, left, marked, &slab_of)).collect();
        for (slab, found) in slabs.into_iter().zip(coarsened) {
            for (triangle, corners) in slab.into_iter().zip(found.triangles) {
                left[triangle as usize] = corners;
            }
            for ((point, is_held), is_changed) in
                found.points.into_iter().zip(found.is_held).zip(found.is_changed)
            {
                let marked = &mut marked[point as usize];
                *marked = is_held && (*marked || is_changed);
            }
        }
    }

    fn coarsened_slab(&self, slab: &[u32], left: &[Corners], marked: &[bool], slab_of: &[u32]) -> Coarsened {
        let corners = || slab.iter().filter_map(|triangle| left[*triangle as usize]);
        let mut points: Vec<u32> = corners().flatten().map(|corner| corner.vertex).collect();
        points.sort_unstable();
        points.dedup();
        let number = |point: u32| points.binary_search(&point).expect("corners are listed");
        let numbered =
            |corner: PeriodicVertex| PeriodicVertex { vertex: id(number(corner.vertex)), ..corner };
        let triangles: Vec<_> = corners().map(|corners| corners.map(numbered)).collect();
        // Whether an edge may collapse depends on all triangles around its ends, and on those beside these.
        let mut is_held = vec![false; points.len()];
        for corners in &triangles {
            let is_shared =
                |corner: &PeriodicVertex| slab_of[points[corner.vertex as usize] as usize] == SHARED;
            if corners.iter().any(is_shared) {
                corners.iter().for_each(|corner| is_held[corner.vertex as usize] = true);
            }
        }
        let positions: Vec<DVec3> = points.iter().map(|point| self.points[*point as usize]).collect();
        let limit = |(point, is_held): (&u32, &bool)| self.limits[*point as usize].filter(|_| !is_held);
        let limits: Vec<Option<f64>> = points.iter().zip(&is_held).map(limit).collect();
        let sides: Vec<[Side; 2]> = slab.iter().map(|triangle| self.sides[*triangle as usize]).collect();
        let mut is_changed: Vec<bool> = points.iter().map(|point| marked[*point as usize]).collect();
        let triangles = triangles.into_iter().map(Some).collect();
        let found = coarsened_around(self.domain, &positions, &limits, triangles, &sides, &mut is_changed);
        let global =
            |corner: PeriodicVertex| PeriodicVertex { vertex: points[corner.vertex as usize], ..corner };
        let triangles = found.into_iter().map(|corners| corners.map(|corners| corners.map(global))).collect();
        Coarsened { triangles, points, is_held, is_changed }
    }
}

/// What is left of a slab.
struct Coarsened {
    /// What is left of each of its triangles.
    triangles: Vec<Corners>,
    /// The points that it had.
    points: Vec<u32>,
    /// Which of them stayed because they are near a border.
    is_held: Vec<bool>,
    /// At which of them triangles changed.
    is_changed: Vec<bool>,
}
