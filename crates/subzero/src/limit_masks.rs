//! Limit position and tangent masks of Loop's scheme, from the left eigenvectors of its rules.

use std::f64::consts::{PI, TAU};

use crate::LoopWeights;

/// Weights of a vertex and of its neighbours, counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RingMask {
    pub centre: f64,
    pub ring: Vec<f64>,
}

/// A count as a number to compute with; no mesh has so many edges that this would round.
#[allow(clippy::cast_precision_loss)]
fn real(count: usize) -> f64 {
    count as f64
}

/// Limit position of a smooth vertex with `valence` neighbours.
pub(crate) fn smooth_position(valence: usize, weights: LoopWeights) -> RingMask {
    let n = real(valence);
    let neighbour = 1.0 / (n + 3.0 / (8.0 * weights.neighbour(valence)));
    RingMask { centre: 1.0 - n * neighbour, ring: vec![neighbour; valence] }
}

/// Two limit tangents of a smooth vertex, a right angle apart; the first points at neighbour 0.
pub(crate) fn smooth_tangents(valence: usize) -> [RingMask; 2] {
    let step = TAU / real(valence);
    let cosines = (0..valence).map(|i| (step * real(i)).cos()).collect();
    [RingMask { centre: 0.0, ring: cosines }, sines(valence)]
}

fn sines(valence: usize) -> RingMask {
    let step = TAU / real(valence);
    RingMask { centre: 0.0, ring: (0..valence).map(|i| (step * real(i)).sin()).collect() }
}

/// Limit tangents in a sector between two creases with `edges` edges, both creases counted; smooth along the crease.
///
/// The first points along the crease at edge 0, the second into the sector. The second is the exact eigenvector of the
/// rules used here; Hoppe et al. 1994 give one that belongs to other edge rules.
pub(crate) fn crease_tangents(edges: usize, weights: LoopWeights) -> [RingMask; 2] {
    let last = edges - 1;
    let mut along = RingMask { centre: 0.0, ring: vec![0.0; edges] };
    along.ring[0] = 1.0;
    along.ring[last] = -1.0;
    if edges == 2 {
        return [along, RingMask { centre: -2.0, ring: vec![1.0, 1.0] }];
    }
    let angle = PI / real(last);
    if weights == LoopWeights::BiermannLevinZorin {
        let mut ring: Vec<f64> = (0..edges).map(|i| (angle * real(i)).sin()).collect();
        let ends = (angle.sin() - 1.0 / (angle / 2.0).tan()) / 2.0;
        ring[0] = ends;
        ring[last] = ends;
        return [along, RingMask { centre: -angle.sin(), ring }];
    }
    let inside = (2.0 * angle.cos() + 1.0) * (angle / 2.0).tan();
    let mut ring: Vec<f64> = (0..edges).map(|i| inside * (angle * real(i)).sin()).collect();
    ring[0] = -angle.cos();
    ring[last] = -angle.cos();
    [along, RingMask { centre: -1.0, ring }]
}

/// Limit tangents in a sector of a corner with `edges` edges, along its two creases.
pub(crate) fn corner_tangents(edges: usize) -> [RingMask; 2] {
    [0, edges - 1].map(|crease| {
        let mut ring = vec![0.0; edges];
        ring[crease] = 1.0;
        RingMask { centre: -1.0, ring }
    })
}

/// Limit position of a dart, whose sharp edge is edge 0.
///
/// With the centre's weight set to 1, the rules ask of the weights w_1 .. w_(n-1) that w_(i-1) - 5 w_i + w_(i+1) = -8 b, and
/// that w_0 counts as 0 there; the solution is a constant minus a hyperbolic cosine around the edge opposite.
pub(crate) fn dart_position(valence: usize, weights: LoopWeights) -> RingMask {
    let n = real(valence);
    let beta = weights.neighbour(valence);
    let decay = f64::acosh(2.5);
    let cosh_ratio = |i: f64| ((-decay * i).exp() + (-decay * (n - i)).exp()) / (1.0 + (-decay * n).exp());
    let mut ring: Vec<f64> = (0..valence).map(|i| beta * 8.0 / 3.0 * (1.0 - cosh_ratio(real(i)))).collect();
    ring[0] = 2.0 * beta + 0.5 * ring[1];
    let total = 1.0 + ring.iter().sum::<f64>();
    RingMask { centre: 1.0 / total, ring: ring.into_iter().map(|w| w / total).collect() }
}

/// Two limit tangents of a dart, whose sharp edge is edge 0: along it, and across to its left.
pub(crate) fn dart_tangents(valence: usize, weights: LoopWeights) -> [RingMask; 2] {
    // The eigenvalue of the mirror-symmetric tangent lies between those where x vanishes.
    let n = real(valence);
    let (mut low, mut high) = (3.0 * PI / n, PI / n);
    let sign_low = dart_residual(low, valence, weights).1 > 0.0;
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if (dart_residual(middle, valence, weights).1 > 0.0) == sign_low {
            low = middle;
        } else {
            high = middle;
        }
    }
    let (mut along, _) = dart_residual(0.5 * (low + high), valence, weights);
    // An eigenvector's sign is free: point along the sharp edge.
    let step = TAU / n;
    let forward: f64 = along.ring.iter().enumerate().map(|(i, w)| w * (step * real(i)).cos()).sum();
    if forward < 0.0 {
        along.centre = -along.centre;
        along.ring.iter_mut().for_each(|w| *w = -*w);
    }
    [along, sines(valence)]
}

/// The mirror-symmetric weights that satisfy the dart's eigenvector equations for the eigenvalue 3/8 + cos(angle)/4, all
/// but that of edge 0, and what this one misses by.
fn dart_residual(angle: f64, valence: usize, weights: LoopWeights) -> (RingMask, f64) {
    let n = real(valence);
    let beta = weights.neighbour(valence);
    let eigenvalue = 0.375 + 0.25 * angle.cos();
    let centre = (angle * n / 2.0).cos();
    let scale = beta / (0.625 - eigenvalue);
    let mut ring: Vec<f64> =
        (0..valence).map(|i| scale * ((angle * (real(i) - n / 2.0)).cos() - centre)).collect();
    let others: f64 = ring[1..].iter().sum();
    ring[0] = -2.0 * ((1.0 - n * beta - eigenvalue) * centre + 0.375 * others);
    let residual = (eigenvalue - 0.5) * ring[0] - beta * centre - 0.25 * ring[1];
    (RingMask { centre, ring }, residual)
}
