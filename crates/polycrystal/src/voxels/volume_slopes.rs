//! How the volumes of grains grow with the points of their boundaries.

use std::collections::{BTreeMap, HashMap};

use glam::{BVec3, DVec3};
use rayon::prelude::*;
use voronoi::Dimension;

use crate::mesh::grouped::Grouped;
use crate::mesh::id::id;
use crate::mesh::volume::{Cone, ConeSum};
use crate::voxels::elements::CutFaces;
use crate::{Elements, Side, Surface};

/// Elements, and how they meet in points.
pub(super) struct VolumeSlopes<'a> {
    pub(super) cut: &'a CutFaces,
    /// The sides of each kind of element.
    pub(super) sides: &'a [[Side; 2]],
    at_points: Grouped<u32>,
    /// Of each point: the kind of the elements at it, if all of them have it and the point itself for a corner.
    kind_at: Vec<u32>,
}

/// Of a point at which elements of several kinds meet, or some that have a copy of it.
const SEVERAL: u32 = u32::MAX;

/// Points that a thread adds up in one go; sums depend on it, but not on the number of threads.
const POINTS_AT_ONCE: usize = 1 << 16;

/// Volumes where points are, and how they grow when points move along their slopes, as far as these are free.
pub(super) struct Growth {
    pub(super) volumes: Vec<f64>,
    /// By how much one grain grows when all points move by the slopes of another, times their mobilities; symmetric.
    pub(super) matrix: Vec<BTreeMap<u32, f64>>,
}

/// How the volumes of grains grow with a point.
#[derive(Default)]
struct Slopes {
    of_grains: Vec<(u32, DVec3)>,
    /// How far the point goes along its slopes: the inverse of the area that stands on it.
    mobility: f64,
}

/// What the elements of a kind add up to at some points.
#[derive(Default, Clone)]
struct KindSum {
    /// The first of the points.
    apex: DVec3,
    /// Of the cone from there, times the dimension.
    volume: f64,
    /// The sum of normals, each as long as the area.
    area: DVec3,
    /// How the first side grows when points where all is of this kind move.
    growth: f64,
}

/// Sums over some points that follow each other. The order of entries decides nothing: each is there once.
#[derive(Default)]
struct Part {
    of_kinds: HashMap<u32, KindSum>,
    /// What pairs of grains, the lower first, have from points where several kinds meet.
    of_pairs: HashMap<[u32; 2], f64>,
}

impl<'a> VolumeSlopes<'a> {
    /// Those of so many points.
    pub(super) fn new(point_count: usize, cut: &'a CutFaces, sides: &'a [[Side; 2]]) -> Self {
        let at_points = cut.at_points(point_count);
        let kind_at = |point: usize| {
            let elements = at_points.of(point);
            let kind = |element: &u32| cut.kind_of[*element as usize].0;
            let first = elements.first().map_or(SEVERAL, kind);
            let is_alike = |element: &u32| {
                kind(element) == first && cut.elements().corners(*element).contains(&id(point))
            };
            if elements.iter().all(is_alike) { first } else { SEVERAL }
        };
        let kind_at = (0..point_count).into_par_iter().map(kind_at).collect();
        Self { cut, sides, at_points, kind_at }
    }

    /// The elements between points, with copies behind.
    pub(super) fn surface<'b>(&'b self, points: &'b [DVec3]) -> Surface<'b> {
        let CutFaces { kind_of, .. } = self.cut;
        Surface { points, elements: self.cut.elements(), boundary_of: kind_of, sides: self.sides }
    }

    /// The elements at a point, and at its copies.
    pub(super) fn at_point(&self, point: u32) -> &[u32] {
        self.at_points.of(point as usize)
    }

    /// Volumes of so many grains and how they grow, by all points but along the axes that are bound. `directions` becomes, for points where all elements are of one kind, the way
    /// in which they go when the first side grows.
    pub(super) fn growth(
        &self,
        grain_count: usize,
        points: &[DVec3],
        is_bound: impl Fn(usize) -> BVec3 + Sync,
        directions: &mut [DVec3],
    ) -> Growth {
        let with_copies = self.cut.copies.with_copies(points);
        let part = |(chunk, directions): (usize, &mut [DVec3])| {
            self.part(chunk * POINTS_AT_ONCE, &with_copies, &is_bound, directions)
        };
        let parts: Vec<Part> = directions.par_chunks_mut(POINTS_AT_ONCE).enumerate().map(part).collect();
        let mut matrix: Vec<BTreeMap<u32, f64>> = vec![BTreeMap::new(); grain_count];
        let mut add = |[grain, other]: [u32; 2], value: f64| {
            *matrix[grain as usize].entry(other).or_default() += value;
            if grain != other {
                *matrix[other as usize].entry(grain).or_default() += value;
            }
        };
        let dimension = self.cut.elements().dimension();
        let parts_of_cone = match dimension {
            Dimension::Two => 2.0,
            Dimension::Three => 3.0,
        };
        let mut of_kinds: Vec<Option<KindSum>> = vec![None; self.sides.len()];
        for part in parts {
            for (kind, sum) in part.of_kinds {
                match &mut of_kinds[kind as usize] {
                    Some(known) => known.add(&sum),
                    unknown => *unknown = Some(sum),
                }
            }
            part.of_pairs.into_iter().for_each(|(pair, value)| add(pair, value));
        }
        let mut volumes = vec![ConeSum::default(); grain_count];
        for (sides, sum) in self.sides.iter().zip(of_kinds) {
            let Some(sum) = sum else { continue };
            let cone = Cone::new(sum.apex, sum.volume / parts_of_cone, sum.area, dimension);
            let grains = sides.map(|side| side.grain());
            for (grain, sign) in grains.iter().zip([1.0, -1.0]) {
                let Some(grain) = grain else { continue };
                volumes[grain.index()].add(&cone, sign);
                add([grain.0; 2], sum.growth);
            }
            if let [Some(first), Some(second)] = grains {
                add([first.0, second.0], -sum.growth);
            }
        }
        Growth { volumes: volumes.into_iter().map(|sum| sum.volume).collect(), matrix }
    }
}

impl VolumeSlopes<'_> {
    fn part(
        &self,
        first: usize,
        with_copies: &[DVec3],
        is_bound: &impl Fn(usize) -> BVec3,
        directions: &mut [DVec3],
    ) -> Part {
        let mut part = Part::default();
        let mut slopes = Slopes::default();
        for (point, direction) in (first..).zip(directions) {
            let kind = self.kind_at[point];
            if kind == SEVERAL {
                self.find_slopes(&mut slopes, with_copies, point, |element, normal| {
                    let corners = self.cut.elements().corners(element);
                    let is_here = |corner: &&u32| self.cut.copies.original(**corner) as usize == point;
                    let corner = *corners.iter().find(is_here).expect("the element is at this point");
                    let kind = self.cut.kind_of[element as usize].0;
                    part.of_kind(kind, with_copies[corner as usize])
                        .add_normal(with_copies[corner as usize], normal);
                });
                part.add_pairs(&slopes, is_bound(point));
                continue;
            }
            let (mut normal, mut area) = (DVec3::ZERO, 0.0);
            for element in self.at_points.of(point) {
                let own = self.normal_share(with_copies, *element);
                normal += own;
                area += own.length();
            }
            *direction = if area > 0.0 { normal / area } else { DVec3::ZERO };
            let sum = part.of_kind(kind, with_copies[point]);
            sum.add_normal(with_copies[point], normal);
            sum.growth += DVec3::select(is_bound(point), DVec3::ZERO, *direction).dot(normal);
        }
        part
    }

    /// The part of an element's normal, as long as the area, that belongs to each corner.
    fn normal_share(&self, with_copies: &[DVec3], element: u32) -> DVec3 {
        let elements = self.cut.elements();
        // A third of each triangle's area, and half of each segment's length.
        let share = if let Elements::Segments(_) = elements { 2.0 } else { 6.0 };
        elements.normal(with_copies, element) / share
    }

    /// How volumes grow with a point, where elements are between these. `each` is told the elements, and the shares of their normals.
    fn find_slopes(
        &self,
        found: &mut Slopes,
        with_copies: &[DVec3],
        point: usize,
        mut each: impl FnMut(u32, DVec3),
    ) {
        found.of_grains.clear();
        let mut area = 0.0;
        for element in self.at_points.of(point) {
            let normal = self.normal_share(with_copies, *element);
            each(*element, normal);
            let sides = self.sides[self.cut.kind_of[*element as usize].index()];
            // Elements of copies, which alone have the outside first, are there already.
            if sides[0] != Side::Exterior {
                area += normal.length();
            }
            for (side, sign) in sides.into_iter().zip([1.0, -1.0]) {
                let Side::Grain(grain) = side else { continue };
                match found.of_grains.iter_mut().find(|(known, _)| *known == grain.0) {
                    Some((_, slope)) => *slope += normal * sign,
                    None => found.of_grains.push((grain.0, normal * sign)),
                }
            }
        }
        found.mobility = if area > 0.0 { 1.0 / area } else { 0.0 };
    }

    /// Turns the directions that [`growth`](Self::growth) found into motions, by a multiplier for each grain.
    pub(super) fn motions(&self, points: &[DVec3], multipliers: &[f64], directions: &mut [DVec3]) {
        let with_copies = self.cut.copies.with_copies(points);
        let of_side = |side: Side| side.grain().map_or(0.0, |grain| multipliers[grain.index()]);
        let of_kind: Vec<f64> =
            self.sides.iter().map(|[first, second]| of_side(*first) - of_side(*second)).collect();
        let moving = directions.par_iter_mut().enumerate();
        moving.for_each_init(Slopes::default, |slopes, (point, motion)| {
            let kind = self.kind_at[point];
            if kind != SEVERAL {
                *motion *= of_kind[kind as usize];
                return;
            }
            self.find_slopes(slopes, &with_copies, point, |_, _| ());
            let along = slopes.of_grains.iter();
            let sum: DVec3 = along.map(|(grain, slope)| *slope * multipliers[*grain as usize]).sum();
            *motion = sum * slopes.mobility;
        });
    }
}

impl Part {
    /// What a kind adds up to, from some point if it has none yet.
    fn of_kind(&mut self, kind: u32, apex: DVec3) -> &mut KindSum {
        self.of_kinds.entry(kind).or_insert_with(|| KindSum { apex, ..KindSum::default() })
    }

    fn add_pairs(&mut self, slopes: &Slopes, is_bound: BVec3) {
        for (place, (grain, slope)) in slopes.of_grains.iter().enumerate() {
            let free = DVec3::select(is_bound, DVec3::ZERO, *slope * slopes.mobility);
            for (other, along) in &slopes.of_grains[..=place] {
                let pair = [*grain.min(other), *grain.max(other)];
                *self.of_pairs.entry(pair).or_default() += free.dot(*along);
            }
        }
    }
}

impl KindSum {
    /// Adds the share of a normal that belongs to a corner.
    fn add_normal(&mut self, corner: DVec3, normal: DVec3) {
        self.volume += (corner - self.apex).dot(normal);
        self.area += normal;
    }

    fn add(&mut self, other: &Self) {
        self.volume += other.volume + (other.apex - self.apex).dot(other.area);
        self.area += other.area;
        self.growth += other.growth;
    }
}
