//! Short edges that collapse in many tiles at once.

use glam::DVec3;
use rayon::prelude::*;
use voronoi::{Domain, PeriodicVertex, Side};

use crate::BoundaryId;
use crate::mesh::id::id;
use crate::network::coarsening::coarsened_around;

/// A surface cut into cubes.
pub(super) struct Tiles<'a> {
    pub(super) domain: &'a Domain,
    pub(super) points: &'a [DVec3],
    /// Of each point: edges at it that are shorter collapse.
    pub(super) limits: &'a [Option<f64>],
    pub(super) kind_of: &'a [BoundaryId],
    /// Of each kind of triangle.
    pub(super) sides: &'a [[Side; 2]],
    /// The edge of a tile.
    pub(super) edge: f64,
}

/// Of a triangle, while it is there.
pub(super) type Corners = Option<[PeriodicVertex; 3]>;

/// Of a point: it is in no tile yet, or in several.
const NOWHERE: u32 = u32::MAX;
const SHARED: u32 = u32::MAX - 1;

impl Tiles<'_> {
    /// As [`coarsened`](crate::network::coarsening::coarsened) with other choices near the borders of tiles; the number of threads decides nothing.
    ///
    /// Points at borders stay at first. Then tiles begin half an edge further up, and a quarter. Last, in one tile and by one thread, come the points that stayed each time.
    pub(super) fn coarsen(&self, left: &mut [Corners]) {
        let mut marked = vec![true; self.points.len()];
        for (edge, begin) in [(self.edge, 0.0), (self.edge, 0.5), (self.edge, 0.25), (f64::INFINITY, 0.0)] {
            self.coarsen_each(left, &mut marked, edge, begin);
        }
    }

    /// Coarsens each tile by itself. Points stay marked where something may be left to do.
    fn coarsen_each(&self, left: &mut [Corners], marked: &mut [bool], edge: f64, begin: f64) {
        let along = |place: DVec3| (place / edge + begin).as_usizevec3();
        let last = along(self.domain.upper());
        let mut tiles: Vec<Vec<u32>> = vec![Vec::new(); (last + 1).element_product()];
        let mut tile_of = vec![NOWHERE; self.points.len()];
        for (triangle, corners) in (0u32..).zip(left.iter()) {
            let Some(corners) = corners else { continue };
            let at = along(self.points[corners[0].vertex as usize]);
            let tile = (at.z * (last.y + 1) + at.y) * (last.x + 1) + at.x;
            tiles[tile].push(triangle);
            for corner in corners {
                let known = &mut tile_of[corner.vertex as usize];
                *known = if [NOWHERE, id(tile)].contains(known) { id(tile) } else { SHARED };
            }
        }
        let coarsened: Vec<Coarsened> =
            tiles.par_iter().map(|tile| self.coarsened_tile(tile, left, marked, &tile_of)).collect();
        for (tile, found) in tiles.into_iter().zip(coarsened) {
            tile.into_iter().for_each(|triangle| left[triangle as usize] = None);
            found.left.into_iter().for_each(|(triangle, corners)| left[triangle as usize] = Some(corners));
            for ((point, is_held), is_changed) in
                found.points.into_iter().zip(found.is_held).zip(found.is_changed)
            {
                let marked = &mut marked[point as usize];
                *marked = is_held && (*marked || is_changed);
            }
        }
    }

    fn coarsened_tile(&self, tile: &[u32], left: &[Corners], marked: &[bool], tile_of: &[u32]) -> Coarsened {
        let corners = || tile.iter().filter_map(|triangle| left[*triangle as usize]);
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
                |corner: &PeriodicVertex| tile_of[points[corner.vertex as usize] as usize] == SHARED;
            if corners.iter().any(is_shared) {
                corners.iter().for_each(|corner| is_held[corner.vertex as usize] = true);
            }
        }
        let positions: Vec<DVec3> = points.iter().map(|point| self.points[*point as usize]).collect();
        let limit = |(point, is_held): (&u32, &bool)| self.limits[*point as usize].filter(|_| !is_held);
        let limits: Vec<Option<f64>> = points.iter().zip(&is_held).map(limit).collect();
        let sides_of = |triangle: &u32| self.sides[self.kind_of[*triangle as usize].index()];
        let sides: Vec<[Side; 2]> = tile.iter().map(sides_of).collect();
        let mut is_changed: Vec<bool> = points.iter().map(|point| marked[*point as usize]).collect();
        let triangles = triangles.into_iter().map(Some).collect();
        let found = coarsened_around(self.domain, &positions, &limits, triangles, &sides, &mut is_changed);
        let global =
            |corner: PeriodicVertex| PeriodicVertex { vertex: points[corner.vertex as usize], ..corner };
        let left =
            tile.iter().zip(found).filter_map(|(triangle, corners)| Some((*triangle, corners?.map(global))));
        Coarsened { left: left.collect(), points, is_held, is_changed }
    }
}

/// What is left of a tile.
struct Coarsened {
    /// Its triangles that are left: few, and other tiles wait with theirs.
    left: Vec<(u32, [PeriodicVertex; 3])>,
    /// The points that it had.
    points: Vec<u32>,
    /// Which of them stayed because they are near a border.
    is_held: Vec<bool>,
    /// At which of them triangles changed.
    is_changed: Vec<bool>,
}
