//! Short edges that collapse in many slabs at once.

use glam::DVec3;
use rayon::prelude::*;
use voronoi::{Domain, PeriodicVertex, Side};

use crate::BoundaryId;
use crate::mesh::id::id;
use crate::network::coarsening::coarsened_around;

/// A surface cut into slabs across an axis.
pub(super) struct Slabs<'a> {
    pub(super) domain: &'a Domain,
    pub(super) points: &'a [DVec3],
    /// Of each point: edges at it that are shorter collapse.
    pub(super) limits: &'a [Option<f64>],
    pub(super) kind_of: &'a [BoundaryId],
    /// Of each kind of triangle.
    pub(super) sides: &'a [[Side; 2]],
    pub(super) axis: usize,
    pub(super) thickness: f64,
}

/// Of a triangle, while it is there.
pub(super) type Corners = Option<[PeriodicVertex; 3]>;

/// Of a point: it is in no slab yet, or in several.
const NOWHERE: u32 = u32::MAX;
const SHARED: u32 = u32::MAX - 1;

impl Slabs<'_> {
    /// As [`coarsened`](crate::network::coarsening::coarsened) with other choices near the borders of slabs; the number of threads decides nothing.
    ///
    /// Points at borders stay at first. Then slabs begin half a thickness further up, and last, in one slab, come the points that stayed twice.
    pub(super) fn coarsen(&self, left: &mut [Corners]) {
        let mut marked = vec![true; self.points.len()];
        for (thickness, begin) in [(self.thickness, 0.0), (self.thickness, 0.5), (f64::INFINITY, 0.0)] {
            self.coarsen_each(left, &mut marked, thickness, begin);
        }
    }

    /// Coarsens each slab by itself. Points stay marked where something may be left to do.
    fn coarsen_each(&self, left: &mut [Corners], marked: &mut [bool], thickness: f64, begin: f64) {
        let mut slabs: Vec<Vec<u32>> = Vec::new();
        let mut slab_of = vec![NOWHERE; self.points.len()];
        for (triangle, corners) in (0u32..).zip(left.iter()) {
            let Some(corners) = corners else { continue };
            let height = self.points[corners[0].vertex as usize][self.axis] / thickness + begin;
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
            slab.into_iter().for_each(|triangle| left[triangle as usize] = None);
            found.left.into_iter().for_each(|(triangle, corners)| left[triangle as usize] = Some(corners));
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
        let sides_of = |triangle: &u32| self.sides[self.kind_of[*triangle as usize].index()];
        let sides: Vec<[Side; 2]> = slab.iter().map(sides_of).collect();
        let mut is_changed: Vec<bool> = points.iter().map(|point| marked[*point as usize]).collect();
        let triangles = triangles.into_iter().map(Some).collect();
        let found = coarsened_around(self.domain, &positions, &limits, triangles, &sides, &mut is_changed);
        let global =
            |corner: PeriodicVertex| PeriodicVertex { vertex: points[corner.vertex as usize], ..corner };
        let left =
            slab.iter().zip(found).filter_map(|(triangle, corners)| Some((*triangle, corners?.map(global))));
        Coarsened { left: left.collect(), points, is_held, is_changed }
    }
}

/// What is left of a slab.
struct Coarsened {
    /// Its triangles that are left: few, and other slabs wait with theirs.
    left: Vec<(u32, [PeriodicVertex; 3])>,
    /// The points that it had.
    points: Vec<u32>,
    /// Which of them stayed because they are near a border.
    is_held: Vec<bool>,
    /// At which of them triangles changed.
    is_changed: Vec<bool>,
}
