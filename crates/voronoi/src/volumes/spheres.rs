//! Spheres that do not overlap, placed at random, the largest first.

use std::f64::consts::PI;

use cancellation::check_cancelled;
use glam::{DVec3, UVec3};

use super::shape::{GrainShape, InscribedSphere};
use super::{VolumesError, check_volumes};
use crate::{Dimension, Domain, Translation};

/// The part of a cell's volume that its sphere takes up at first. Random places for equal spheres run out at 0.38 in space and
/// 0.55 in the plane; with 0.35 ten centroid steps give 13.7 faces a grain, as metals have.
pub(super) const SPHERE_FRACTION: f64 = 0.35;

/// How many places a sphere tries before it takes that of least overlap: 5 of 2000 spheres of cv 0.35 come to that.
const MOST_PLACES: usize = 200;

/// How many points of the domain's box are drawn before one is taken toward the domain's middle.
const MOST_POINTS: usize = 1000;

/// Radius of the sphere around a seed for a cell's volume (in the plane: area).
pub(super) fn sphere_radius(dimension: Dimension, volume: f64) -> f64 {
    match dimension {
        Dimension::Two => (SPHERE_FRACTION * volume / PI).sqrt(),
        Dimension::Three => (SPHERE_FRACTION * 0.75 * volume / PI).cbrt(),
    }
}

/// Seeds for cells of given volumes (in the plane: areas): the centres of spheres a third as large that do not overlap, placed at
/// random, the largest first (random sequential addition). Where there is no room left, the sphere takes the place of least overlap.
///
/// `fraction` gives random numbers from 0 up to but not including 1.
///
/// # Errors
/// [`VolumesError`] for volumes that are not positive or do not add up to the domain's.
pub fn place_spheres(
    domain: &Domain,
    volumes: &[f64],
    mut fraction: impl FnMut() -> f64,
) -> Result<Vec<DVec3>, VolumesError> {
    let volumes = check_volumes(domain, volumes)?;
    let radii: Vec<f64> = volumes.iter().map(|volume| sphere_radius(domain.dimension(), *volume)).collect();
    let mut order: Vec<usize> = (0..radii.len()).collect();
    order.sort_unstable_by(|a, b| radii[*b].total_cmp(&radii[*a]).then(a.cmp(b)));
    let mut seeds = vec![DVec3::ZERO; radii.len()];
    let mut classes: Vec<SphereGrid> = Vec::new();
    for (rank, &sphere) in order.iter().enumerate() {
        check_cancelled();
        let radius = radii[sphere];
        if classes.last().is_none_or(|class| radius < 0.5 * class.largest_radius) {
            classes.push(SphereGrid::new(domain, radius, order.len() - rank));
        }
        let place = roomiest_place(
            || random_point(domain, &mut fraction),
            |place, enough| largest_overlap(&classes, [(place, radius)], enough),
        );
        seeds[sphere] = place;
        if let Some(class) = classes.last_mut() {
            class.insert(place, radius);
        }
    }
    Ok(seeds)
}

/// The same for grains of given shapes: the centres of ellipsoids a third as large, as the spheres inscribed in them tell whether two
/// overlap.
///
/// # Errors
/// As [`place_spheres`].
///
/// # Panics
/// When there are not as many shapes as volumes.
pub fn place_ellipsoids(
    domain: &Domain,
    volumes: &[f64],
    shapes: &[GrainShape],
    mut fraction: impl FnMut() -> f64,
) -> Result<Vec<DVec3>, VolumesError> {
    assert_eq!(volumes.len(), shapes.len(), "one shape for each volume");
    let volumes = check_volumes(domain, volumes)?;
    let dimension = domain.dimension();
    let bodies: Vec<Vec<InscribedSphere>> = volumes
        .iter()
        .zip(shapes)
        .map(|(volume, shape)| shape.inscribed_spheres(dimension, SPHERE_FRACTION * volume, 0))
        .collect();
    let squares = || bodies.iter().flatten().map(|sphere| sphere.squared_radius);
    let mut grid = SphereGrid::new(domain, squares().fold(0.0, f64::max).sqrt(), squares().count());
    let mut order: Vec<usize> = (0..bodies.len()).collect();
    order.sort_unstable_by(|a, b| volumes[*b].total_cmp(&volumes[*a]).then(a.cmp(b)));
    let mut centers = vec![DVec3::ZERO; bodies.len()];
    for body in order {
        check_cancelled();
        // Spheres that reach out of the domain overlap nothing.
        let spheres = |place: DVec3| {
            let inside =
                bodies[body].iter().map(move |sphere| (place + sphere.center, sphere.squared_radius));
            inside
                .map(|(center, square)| (wrapped(domain, center), square.sqrt()))
                .filter(|(center, _)| domain.contains(*center))
        };
        let place = roomiest_place(
            || random_point(domain, &mut fraction),
            |place, enough| largest_overlap(std::slice::from_ref(&grid), spheres(place), enough),
        );
        centers[body] = place;
        for (center, radius) in spheres(place) {
            grid.insert(center, radius);
        }
    }
    Ok(centers)
}

/// The first of some places that has no overlap, or else the one of least; `overlap` may end early where it is enough.
fn roomiest_place(mut draw: impl FnMut() -> DVec3, overlap: impl Fn(DVec3, f64) -> f64) -> DVec3 {
    // How much it is counts only where no place is free: most are not, and most spheres find one.
    let mut taken = Vec::new();
    for _ in 0..MOST_PLACES {
        let place = draw();
        if overlap(place, f64::MIN_POSITIVE) <= 0.0 {
            return place;
        }
        taken.push(place);
    }
    let mut best = (f64::INFINITY, DVec3::ZERO);
    for place in taken {
        let overlap = overlap(place, best.0);
        if overlap < best.0 {
            best = (overlap, place);
        }
    }
    best.1
}

/// The largest overlap of some spheres with those in grids, as of [`SphereGrid::overlap`].
fn largest_overlap(
    grids: &[SphereGrid<'_>],
    spheres: impl IntoIterator<Item = (DVec3, f64)>,
    enough: f64,
) -> f64 {
    let mut most = f64::NEG_INFINITY;
    for (center, radius) in spheres {
        for grid in grids {
            most = most.max(grid.overlap(center, radius, enough));
            if most >= enough {
                return most;
            }
        }
    }
    most
}

/// A place moved by whole periods into the domain.
pub(super) fn wrapped(domain: &Domain, place: DVec3) -> DVec3 {
    let (lower, period) = (domain.lower(), domain.size());
    let share = (place - lower) / period;
    let inside = lower + (share - share.floor()) * period;
    // Rounding may lead to the upper end, which is the lower one.
    let inside = DVec3::select(inside.cmpge(domain.upper()), lower, inside);
    DVec3::select(domain.periodic(), inside, place)
}

/// The whole periods nearest to a way.
pub(super) fn whole_periods(domain: &Domain, way: DVec3) -> Translation {
    let periods = DVec3::select(domain.periodic(), (way / domain.size()).round(), DVec3::ZERO);
    Translation(periods.as_i8vec3().to_array())
}

fn random_point(domain: &Domain, fraction: &mut impl FnMut() -> f64) -> DVec3 {
    let mut draw = || {
        let share = DVec3::new(fraction(), fraction(), 0.0);
        let share = if domain.dimension() == Dimension::Two { share } else { share.with_z(fraction()) };
        (domain.lower() + share * domain.size()).min(domain.upper())
    };
    let mut point = draw();
    for _ in 0..MOST_POINTS {
        if domain.contains(point) {
            return point;
        }
        point = draw();
    }
    // The domain fills next to nothing of its box.
    let nearer = |halvings: i32| domain.center().lerp(point, 0.5f64.powi(halvings));
    (1..=60).map(nearer).find(|point| domain.contains(*point)).unwrap_or(domain.center())
}

/// Spheres of similar radius in the blocks of a grid.
pub(super) struct SphereGrid<'a> {
    domain: &'a Domain,
    largest_radius: f64,
    counts: UVec3,
    blocks: Vec<Vec<(DVec3, f64)>>,
}

impl<'a> SphereGrid<'a> {
    /// A grid for spheres up to a radius, in blocks at least as wide as two of them, and not many more blocks than spheres.
    pub(super) fn new(domain: &'a Domain, largest_radius: f64, spheres: usize) -> Self {
        let size = domain.size();
        let filled: f64 = (0..domain.axes()).map(|axis| size[axis]).product();
        let mean_width = (filled / spheres as f64).powf(1.0 / domain.axes() as f64);
        // Casts of numbers too large take the largest, and a million blocks along an axis are enough.
        let counts = (size / mean_width.max(2.0 * largest_radius)).as_uvec3();
        let counts = counts.clamp(UVec3::ONE, UVec3::splat(1 << 20));
        let blocks = counts.to_array().map(|count| count as usize).iter().product();
        Self { domain, largest_radius, counts, blocks: vec![Vec::new(); blocks] }
    }

    fn coordinates(&self, place: DVec3) -> UVec3 {
        let size = self.domain.size();
        let share = DVec3::select(size.cmpgt(DVec3::ZERO), (place - self.domain.lower()) / size, DVec3::ZERO);
        (share * self.counts.as_dvec3()).as_uvec3().min(self.counts - 1)
    }

    fn block(&self, [x, y, z]: [u32; 3]) -> usize {
        let [along_x, along_y, _] = self.counts.to_array().map(|count| count as usize);
        (z as usize * along_y + y as usize) * along_x + x as usize
    }

    pub(super) fn insert(&mut self, center: DVec3, radius: f64) {
        let block = self.block(self.coordinates(center).to_array());
        self.blocks[block].push((center, radius));
    }

    /// By how much a sphere overlaps one of these at most, in units of the sum of both radii; negative if it does not. Where that is as much as
    /// `enough`, it may be more.
    pub(super) fn overlap(&self, center: DVec3, radius: f64, enough: f64) -> f64 {
        let coordinates = self.coordinates(center);
        let [along_x, along_y, along_z] = [0, 1, 2].map(|axis| self.near(axis, coordinates[axis]));
        let blocks = along_z.into_iter().flatten().flat_map(|z| {
            let row = along_y.into_iter().flatten();
            row.flat_map(move |y| along_x.into_iter().flatten().map(move |x| [x, y, z]))
        });
        let spheres = blocks.flat_map(|block| &self.blocks[self.block(block)]);
        let mut most = f64::NEG_INFINITY;
        for (other, other_radius) in spheres {
            let distance = nearest_image(self.domain, center - other).length();
            most = most.max(1.0 - distance / (radius + other_radius));
            if most >= enough {
                break;
            }
        }
        most
    }

    /// A coordinate of a block and those beside it, each once; its own first, where an overlap is likeliest.
    fn near(&self, axis: usize, coordinate: u32) -> [Option<u32>; 3] {
        let count = self.counts[axis];
        let wraps = self.domain.periodic().test(axis) && count > 2;
        let before = coordinate.checked_sub(1).or(wraps.then_some(count - 1));
        let after = if coordinate + 1 < count { Some(coordinate + 1) } else { wraps.then_some(0) };
        [Some(coordinate), before, after]
    }
}

/// The shortest of the ways that differ by periods of the domain.
pub(super) fn nearest_image(domain: &Domain, way: DVec3) -> DVec3 {
    let nearest = way - domain.size() * (way / domain.size()).round();
    DVec3::select(domain.periodic(), nearest, way)
}
