//! The Utah teapot.

use glam::{DVec2, DVec3, dvec2};

use crate::BezierSurface;

/// Radius and height of the parts that turn about the axis, four rings a patch, from the lid's top outward and down: lid, rim, body
/// and the bottom that Blinn added.
const PROFILES: [[DVec2; 4]; 6] = [
    [dvec2(0.0, 3.15), dvec2(0.8, 3.15), dvec2(0.0, 2.85), dvec2(0.2, 2.7)],
    [dvec2(0.2, 2.7), dvec2(0.4, 2.55), dvec2(1.3, 2.55), dvec2(1.3, 2.4)],
    [dvec2(1.4, 2.4), dvec2(1.3375, 2.53125), dvec2(1.4375, 2.53125), dvec2(1.5, 2.4)],
    [dvec2(1.5, 2.4), dvec2(1.75, 1.875), dvec2(2.0, 1.35), dvec2(2.0, 0.9)],
    [dvec2(2.0, 0.9), dvec2(2.0, 0.45), dvec2(1.5, 0.225), dvec2(1.5, 0.15)],
    [dvec2(1.5, 0.15), dvec2(1.5, 0.075), dvec2(1.425, 0.0), dvec2(0.0, 0.0)],
];

/// How far, in radii, the inner control points of a quarter circle lie from its ends' axes.
const QUARTER: f64 = 0.56;
/// The same on the knob, the only ring with a radius of 0.8: Newell rounded 0.448 to 0.45.
const KNOB_QUARTER: f64 = 0.5625;

/// Rings of the handle and of the spout, two patches each that share a ring: x and z of their two points in the plane of
/// symmetry, and their half width.
const TUBES: [[(DVec2, DVec2, f64); 7]; 2] = [
    [
        (dvec2(-1.6, 2.025), dvec2(-1.5, 2.25), 0.3),
        (dvec2(-2.3, 2.025), dvec2(-2.5, 2.25), 0.3),
        (dvec2(-2.7, 2.025), dvec2(-3.0, 2.25), 0.3),
        (dvec2(-2.7, 1.8), dvec2(-3.0, 1.8), 0.3),
        (dvec2(-2.7, 1.575), dvec2(-3.0, 1.35), 0.3),
        (dvec2(-2.5, 1.125), dvec2(-2.65, 0.9375), 0.3),
        (dvec2(-2.0, 0.9), dvec2(-1.9, 0.6), 0.3),
    ],
    [
        (dvec2(1.7, 1.425), dvec2(1.7, 0.6), 0.66),
        (dvec2(2.6, 1.425), dvec2(3.1, 0.825), 0.66),
        (dvec2(2.3, 2.1), dvec2(2.4, 2.025), 0.25),
        (dvec2(2.7, 2.4), dvec2(3.3, 2.4), 0.25),
        (dvec2(2.8, 2.475), dvec2(3.525, 2.49375), 0.25),
        (dvec2(2.9, 2.475), dvec2(3.45, 2.5125), 0.15),
        (dvec2(2.8, 2.4), dvec2(3.2, 2.4), 0.15),
    ],
];

/// The Utah teapot (Newell 1975) as 32 bicubic patches with normals outward, 3.15 high on the plane z = 0, about the z axis.
///
/// Handle and spout run into the body, and the lid does not touch the rim.
pub fn teapot() -> Vec<BezierSurface<DVec3>> {
    let mut patches = Vec::with_capacity(32);
    for profile in PROFILES {
        for quarter in [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y] {
            patches.push(profile.map(|ring| {
                let at = |x: f64, y: f64| (quarter.rotate(dvec2(x, y)) * ring.x).extend(ring.y);
                let inner = if ring.x == 0.8 { KNOB_QUARTER } else { QUARTER };
                [at(0.0, -1.0), at(inner, -1.0), at(1.0, -inner), at(1.0, 0.0)]
            }));
        }
    }
    for rings in TUBES {
        for patch in [&rings[..4], &rings[3..]] {
            for side in [-1.0, 1.0] {
                let control = [0, 1, 2, 3].map(|i| {
                    let (near, far, width) = patch[i];
                    let at = |p: DVec2, y: f64| DVec3::new(p.x, side * y, p.y);
                    let ring = [at(near, 0.0), at(near, width), at(far, width), at(far, 0.0)];
                    if side > 0.0 { ring } else { [ring[3], ring[2], ring[1], ring[0]] }
                });
                patches.push(control);
            }
        }
    }
    patches.into_iter().map(BezierSurface::bicubic).collect()
}
