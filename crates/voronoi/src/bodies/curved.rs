//! Balls, cylinders and discs as polyhedra.
//!
//! The polyhedra have the volume of what they stand for, so faces lie a little inside of it and corners a little outside,
//! neither by more than the chord error.

use std::f64::consts::PI;

use glam::DVec3;

use crate::exact::generator::MOST_WALLS;
use crate::{Dimension, Domain, VoronoiError, WallPlane};

/// Divisions of the icosahedron's edges that still give few enough walls: 10 * 57^2 + 2.
const MOST_DIVISIONS: u32 = 57;

impl Domain {
    /// A ball in space with as many flat faces, hexagons and twelve pentagons, as keep its surface within `chord_error` of
    /// the sphere; volume and centre are those of the ball.
    ///
    /// The faces are those of a Goldberg polyhedron: their normals are the vertices of an icosahedron whose triangles are
    /// divided evenly.
    ///
    /// ```
    /// use glam::DVec3;
    /// use voronoi::{Domain, Tessellation};
    ///
    /// let ball = Domain::ball(DVec3::ZERO, 1.0, 0.02)?;
    /// assert!((ball.measure() - 4.0 / 3.0 * std::f64::consts::PI).abs() < 1e-9);
    /// let halves = Tessellation::new(&ball, &[DVec3::new(0.5, 0.0, 0.0), DVec3::new(-0.5, 0.0, 0.0)])?;
    /// assert!((halves.cell_measures()[0].volume / ball.measure() - 0.5).abs() < 1e-9);
    /// # Ok::<(), voronoi::VoronoiError>(())
    /// ```
    ///
    /// # Errors
    /// [`VoronoiError::BadLength`] unless both lengths are positive and finite; [`VoronoiError::TooManyWalls`].
    pub fn ball(center: DVec3, radius: f64, chord_error: f64) -> Result<Self, VoronoiError> {
        check([("radius", radius), ("chord error", chord_error)])?;
        let share = chord_error / radius;
        // At worst some hundred thousand normals are made in vain.
        let (normals, distance, _) = (1..=MOST_DIVISIONS)
            .map(goldberg)
            .find(|(.., deviation)| *deviation <= share)
            .ok_or(VoronoiError::TooManyWalls { most: MOST_WALLS })?;
        let wall = |normal: &DVec3| WallPlane::HalfSpace {
            normal: *normal,
            offset: normal.dot(center) + distance * radius,
        };
        let name = format!("a ball of radius {radius} with {} faces", normals.len());
        Self::cut_out(normals.iter().map(wall).collect(), Dimension::Three, Some(name))
    }

    /// A cylinder along z with as many flat faces as keep its lateral surface within `chord_error` of the true one; volume and centre
    /// are those of the cylinder. Its ends are the first two walls.
    ///
    /// # Errors
    /// [`VoronoiError::BadLength`] unless all lengths are positive and finite; [`VoronoiError::TooManyWalls`].
    pub fn cylinder(center: DVec3, radius: f64, height: f64, chord_error: f64) -> Result<Self, VoronoiError> {
        check([("radius", radius), ("chord error", chord_error)])?;
        check([("height", height)])?;
        let lateral_surface = regular_polygon(center, radius, chord_error)?;
        let ends = [-1.0, 1.0].map(|direction| WallPlane::HalfSpace {
            normal: DVec3::Z * direction,
            offset: center.z * direction + 0.5 * height,
        });
        let name = format!("a cylinder of radius {radius} with {} faces", lateral_surface.len() + 2);
        Self::cut_out(ends.into_iter().chain(lateral_surface).collect(), Dimension::Three, Some(name))
    }

    /// A disc in the plane z = 0 as a regular polygon within `chord_error` of the circle; area and centre are those of the disc.
    ///
    /// # Errors
    /// [`VoronoiError::BadLength`] unless both lengths are positive and finite; [`VoronoiError::TooManyWalls`].
    pub fn disc(center: DVec3, radius: f64, chord_error: f64) -> Result<Self, VoronoiError> {
        check([("radius", radius), ("chord error", chord_error)])?;
        let walls = regular_polygon(center.with_z(0.0), radius, chord_error)?;
        let name = format!("a disc of radius {radius} with {} sides", walls.len());
        Self::cut_out(walls, Dimension::Two, Some(name))
    }
}

fn check<const N: usize>(lengths: [(&'static str, f64); N]) -> Result<(), VoronoiError> {
    match lengths.into_iter().find(|(_, length)| !(length.is_finite() && *length > 0.0)) {
        Some((what, length)) => Err(VoronoiError::BadLength { what, length }),
        None => Ok(()),
    }
}

/// The sides of a regular polygon around the z axis through `center` as large as the disc.
fn regular_polygon(center: DVec3, radius: f64, chord_error: f64) -> Result<Vec<WallPlane>, VoronoiError> {
    // Distances of sides and of corners from the centre of a polygon as large as the unit disc.
    let distances = |count: f64| {
        let side = (PI / (count * (PI / count).tan())).sqrt();
        (side, side / (PI / count).cos())
    };
    let is_enough = |count: &u16| {
        let (side, corner) = distances(f64::from(*count));
        (1.0 - side).max(corner - 1.0) * radius <= chord_error
    };
    // A cylinder has two more.
    let mut counts = 3..=MOST_WALLS - 2;
    let count = counts.find(is_enough).ok_or(VoronoiError::TooManyWalls { most: MOST_WALLS })?;
    let side = distances(f64::from(count)).0 * radius;
    let wall = |k: u16| {
        let (sine, cosine) = (2.0 * PI * f64::from(k) / f64::from(count)).sin_cos();
        let normal = DVec3::new(cosine, sine, 0.0);
        WallPlane::HalfSpace { normal, offset: normal.dot(center) + side }
    };
    Ok((0..count).map(wall).collect())
}

/// Face normals of a polyhedron with `10 divisions^2 + 2` faces, all as far from the centre, as large as the unit ball; that
/// distance; and how far its surface is from the sphere at most.
fn goldberg(divisions: u32) -> (Vec<DVec3>, f64, f64) {
    let n = divisions as usize;
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let corners: Vec<DVec3> = [-1.0, 1.0]
        .into_iter()
        .flat_map(|a| {
            [-golden, golden].map(|b| [DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)])
        })
        .flatten()
        .collect();
    // Edges have length 2.
    let is_edge = |a: usize, b: usize| corners[a].distance_squared(corners[b]) < 5.0;
    let mut normals: Vec<DVec3> = Vec::new();
    let (mut volume, mut farthest) = (0.0, 0.0f64);
    for (a, b, c) in (0..12).flat_map(|a| (0..a).flat_map(move |b| (0..b).map(move |c| (a, b, c)))) {
        if !(is_edge(a, b) && is_edge(b, c) && is_edge(c, a)) {
            continue;
        }
        // The sum is the same from all triangles that share the point, as two of three terms commute and the third is 0.
        let point = |i: usize, j: usize| {
            let k = n - i - j;
            (corners[a] * i as f64 + corners[b] * j as f64 + corners[c] * k as f64).normalize()
        };
        for i in 0..=n {
            normals.extend((0..=n - i).map(|j| point(i, j)));
        }
        let up = (0..n).flat_map(|i| (0..n - i).map(move |j| [(i, j), (i + 1, j), (i, j + 1)]));
        let down = (1..n).flat_map(|i| (1..=n - i).map(move |j| [(i, j), (i - 1, j), (i, j - 1)]));
        for triangle in up.chain(down) {
            let [p, q, r] = triangle.map(|(i, j)| point(i, j));
            // Where the planes at distance 1 meet: their pole.
            let normal = (q - p).cross(r - p);
            let corner = normal / normal.dot(p);
            farthest = farthest.max(corner.length());
            for (p, q) in [(p, q), (q, r), (r, p)] {
                // The nearest point of the edge between two faces.
                let middle = (p + q) / (1.0 + p.dot(q));
                let volumes = p.dot(middle.cross(corner)) + middle.dot(q.cross(corner));
                volume += volumes * normal.dot(p).signum() / 6.0;
            }
        }
    }
    normals.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z)));
    normals.dedup_by(|a, b| a.distance_squared(*b) < 1e-20);
    let distance = (4.0 * PI / 3.0 / volume.abs()).cbrt();
    (normals, distance, (1.0 - distance).max(distance * farthest - 1.0))
}
