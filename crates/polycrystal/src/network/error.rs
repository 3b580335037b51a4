use std::collections::BTreeSet;
use std::fmt;

use crate::{Fault, Faults, GrainId, Side};

/// A way to a result that was tried before the one that led there, and what it said: geometry that tangles one way need not another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attempt {
    /// What was tried, in a few words.
    pub tried: String,
    /// The error that it ended with.
    pub said: String,
}

impl fmt::Display for Attempt {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}: {}", self.tried, self.said)
    }
}

impl NetworkError {
    /// Notes this error as that of a way that was given up, after those that led to it.
    pub fn give_up(self, tried: impl Into<String>, attempts: &mut Vec<Attempt>) {
        let (before, last) = self.into_attempts();
        attempts.extend(before);
        attempts.push(Attempt { tried: tried.into(), said: last.to_string() });
    }

    /// The error after other ways that were given up, which it then tells too.
    #[must_use]
    pub fn after(self, mut attempts: Vec<Attempt>) -> Self {
        let (before, last) = self.into_attempts();
        attempts.extend(before);
        if attempts.is_empty() { last } else { Self::GivenUp { attempts, last: Box::new(last) } }
    }

    /// What was tried before, and the error that the last way ended with.
    pub fn into_attempts(self) -> (Vec<Attempt>, Self) {
        match self {
            Self::GivenUp { attempts, last } => (attempts, *last),
            error => (Vec::new(), error),
        }
    }

    /// The error that the last way ended with.
    fn last(&self) -> &Self {
        match self {
            Self::GivenUp { last, .. } => last,
            error => error,
        }
    }

    /// Whether geometry tangled on this way, so that another way may lead to a network: no other error is worth a second attempt.
    pub fn is_tangle(&self) -> bool {
        matches!(
            self.last(),
            Self::Invalid(_)
                | Self::Folded { .. }
                | Self::VolumeNotRestored { .. }
                | Self::GrowthNotFollowed { .. }
                | Self::BoundaryTooSmall { .. }
                | Self::GrainInPieces { .. }
                | Self::TouchesItself { .. }
                | Self::CutCrosses { .. }
                | Self::CutInvalid(_)
        )
    }

    /// Whether the planes of a box cannot cut a network where they are, so that planes elsewhere may.
    pub fn is_of_planes(&self) -> bool {
        matches!(self.last(), Self::CutCrosses { .. } | Self::CutInvalid(_))
    }

    /// Whether a shorter relaxation may be without this error.
    pub fn is_of_time(&self) -> bool {
        matches!(
            self.last(),
            Self::Invalid(_)
                | Self::Folded { .. }
                | Self::VolumeNotRestored { .. }
                | Self::GrowthNotFollowed { .. }
                | Self::GrainVanished { .. }
        )
    }
}

/// A number to three significant digits, however small.
fn to_three_digits(number: f64) -> f64 {
    format!("{number:.2e}").parse().unwrap_or(number)
}

/// Why a network could not be made or relaxed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NetworkError {
    /// The control mesh, or a level of its subdivision, has more parts than 32-bit ids can name.
    #[error(
        "level {level} would have {count} {parts}, more than 32-bit ids can name; use fewer levels or fewer grains"
    )]
    TooLarge {
        /// Level of subdivision.
        level: usize,
        /// Number of parts.
        count: u128,
        /// `triangles` or `edges`.
        parts: &'static str,
    },
    /// The triangulated network is no mesh.
    #[error("the control mesh is broken: {0}")]
    Mesh(#[from] subzero::MeshError),
    /// A boundary is so small that rounding leaves parts of it without area (in the plane: without length):
    /// [`Tessellation::resolved`](voronoi::Tessellation::resolved) takes such out, unless it is a cell's last.
    #[error(
        "the boundary between {} and {} is too small for double precision; remove seeds that are too close, or move those that nearly form a lattice a little",
        sides[0], sides[1]
    )]
    BoundaryTooSmall {
        /// The sides of the boundary.
        sides: [Side; 2],
    },
    /// A labelled surface in a periodic domain.
    #[error("a network of given triangles cannot be periodic; give a domain without periods")]
    PeriodicSurface,
    /// A point or an element at the exterior of whole periodic grains that is no copy of another.
    #[error(
        "point {point} belongs to a periodic network, but lies on no wall and no whole periods away from its original; write the network again"
    )]
    NoPeriodicCopy {
        /// The point.
        point: u32,
    },
    /// A size of elements, or what it is made of, that is none.
    #[error("element sizes, their growth and their share of the radius must be positive and finite, not {0}")]
    BadElementSize(f64),
    /// The remeshed network is not valid, however small elements became where it is not.
    #[error(
        "with elements of that size the network is invalid: {0}; give another size, or more levels of subdivision"
    )]
    RemeshInvalid(Faults),
    /// A triple line that elements of the size asked for cannot grow from.
    #[error(
        "a triple line is only {length:.1e} long: elements beside it would be a millionth of {size:.3} and less, too small for any solver; relax it without --relax 0 and --regularize 0, or merge short lines with --small-features merge"
    )]
    LineTooShort {
        /// Its length.
        length: f64,
        /// The size of elements asked for.
        size: f64,
    },
    /// In the plane, lines between which there are no triangles.
    #[error(
        "lines cross, or touch each other between their points, so that no triangles fit between them; give more levels of subdivision"
    )]
    LinesCross,
    /// Opposite walls of a periodic network that was cut at its box differ.
    #[error(
        "point {point} on a wall has no copy on the opposite one; cut whole grains at the box, and remesh the result"
    )]
    NoCopyOnWall {
        /// The point.
        point: u32,
    },
    /// An element of a labelled surface lies at the exterior, but on no wall.
    #[error(
        "element {element} lies at the exterior, but on no wall of the domain; its corners must lie exactly on a wall"
    )]
    NotOnWall {
        /// The element.
        element: u32,
    },
    /// The grains of a labelled surface are not numbered one after the other.
    #[error("no triangle or segment has grain {} on a side; number grains from 0 without gaps", grain.0)]
    MissingGrain {
        /// The number that is left out.
        grain: GrainId,
    },
    /// No voxel has the label of a grain.
    #[error("no voxel has the label of a grain")]
    NoGrain,
    /// Grains touch themselves in points or along edges of voxels, and other labels for voxels there only move that on.
    #[error(
        "grains touch themselves at {places} points between voxels, and relabelling voxels there does not end; drop small grains"
    )]
    VoxelsTouch {
        /// Number of points.
        places: usize,
    },
    /// There are too few voxels along a period.
    #[error(
        "has {voxels} voxels along {axis}, where it repeats; at least {least} are needed there: leave {axis} out of its periods"
    )]
    ShortPeriod {
        /// The axis.
        axis: char,
        /// Number of voxels along it.
        voxels: usize,
        /// The least number.
        least: usize,
    },
    /// A grain of a map that repeats meets its own image, so that it is not whole anywhere.
    #[error(
        "grain {} meets its own image through the sides of the box, so it has no end; leave out the axes along which it does, or take a larger map",
        grain.0
    )]
    EndlessGrain {
        /// The grain.
        grain: GrainId,
    },
    /// A map that repeats has voxels without a grain.
    #[error(
        "a map that repeats has no exterior, and this one has voxels without a grain; give their label to a grain, or leave the periods out"
    )]
    PeriodicPores,
    /// A grain of several cells is in pieces, or its cells touch in no more than a line somewhere.
    #[error("the cells of grain {} are not connected by faces; number its pieces separately", grain.0)]
    GrainInPieces {
        /// The grain.
        grain: GrainId,
    },
    /// A grain of a periodic network touches its own image in points or lines alone. In the box the two are one grain, whose surface
    /// would touch itself: grains of face-centred lattices with one cell along an axis do.
    #[error(
        "grain {} touches its own image, so cut at the box it would touch itself; keep grains whole, or give more seeds",
        grain.0
    )]
    TouchesItself {
        /// The grain.
        grain: GrainId,
    },
    /// The lines in which boundaries meet a plane of the box cross, or close nothing.
    #[error(
        "boundaries cannot be distinguished on the walls across {axis}; keep grains whole, or move the seeds a little"
    )]
    CutCrosses {
        /// The axis across the plane.
        axis: &'static str,
    },
    /// What is left of a periodic network in its box is no valid network: parts of a grain may touch each other at a wall.
    #[error("cut at the box, the network is invalid: {0}; keep grains whole, or move the seeds a little")]
    CutInvalid(Faults),
    /// The edge length of the control mesh is no length.
    #[error("the edge length is {0}; it must be a positive, finite number")]
    BadEdgeLength(f64),
    /// The relaxation time is negative or not a number.
    #[error("the relaxation time is {0}; it must be 0 (off) or a positive, finite number")]
    BadRelaxationTime(f64),
    /// The mobility of a boundary is not positive.
    #[error(
        "the mobility of the boundary between {} and {} is {mobility}; it must be a positive, finite number",
        sides[0],
        sides[1]
    )]
    BadMobility {
        /// Its sides.
        sides: [Side; 2],
        /// Its mobility.
        mobility: f64,
    },
    /// The tension of a boundary is negative or not a number.
    #[error(
        "the tension between {} and {} is {tension}; it must be 0 or a positive, finite number",
        sides[0], sides[1]
    )]
    BadTension {
        /// The sides of the boundary.
        sides: [Side; 2],
        /// Its tension.
        tension: f64,
    },
    /// The grains' volumes could not be restored.
    #[error(
        "grain {} has the wrong volume after relaxation, with a relative error of {relative_error:.1e}; relax for a shorter time, or not at all",
        grain.0
    )]
    VolumeNotRestored {
        /// The grain that is farthest from its volume.
        grain: GrainId,
        /// Difference to the volume of its cell, as a share of that.
        relative_error: f64,
    },
    /// A boundary stays folded however small the steps.
    #[error(
        "{count} edges inside boundaries are folded after relaxation; relax for a shorter time or use fewer levels"
    )]
    Folded {
        /// Number of edges whose two triangles are more than 90 degrees apart.
        count: usize,
        /// The grains beside them, where they are known.
        grains: Vec<GrainId>,
    },
    /// A grain that is free to shrink has done so to nothing.
    #[error(
        "grain {} shrinks to nothing by the relaxation time {}, and none can vanish; relax for a shorter time, or keep volumes",
        grain.0,
        to_three_digits(*time)
    )]
    GrainVanished {
        /// The grain.
        grain: GrainId,
        /// The time by which it is gone, in units of the mean grain size squared.
        time: f64,
    },
    /// A grain that grows or shrinks faster than the shortest step of a free flow can follow.
    #[error(
        "the volume of grain {} cannot be followed beyond the relaxation time {}; relax for a shorter time, or keep volumes",
        grain.0,
        to_three_digits(*time)
    )]
    GrowthNotFollowed {
        /// The grain whose volume is known worst.
        grain: GrainId,
        /// The time until then, in units of the mean grain size squared.
        time: f64,
    },
    /// The finished network does not keep its contract.
    #[error("the network is invalid: {0}; relax for a shorter time, or move seeds or points a little")]
    Invalid(Faults),
    /// Every way that was tried tangled.
    #[error("{last}")]
    GivenUp {
        /// What the ways before the last one said.
        attempts: Vec<Attempt>,
        /// What the last one said.
        last: Box<NetworkError>,
    },
}

impl NetworkError {
    /// The grains that the error is about: none where it does not know which; nothing where it is about no grain at all.
    pub fn grains(&self) -> Option<Vec<GrainId>> {
        match self {
            Self::BoundaryTooSmall { sides } => Some(sides.iter().filter_map(|side| side.grain()).collect()),
            Self::TouchesItself { grain }
            | Self::GrainInPieces { grain }
            | Self::VolumeNotRestored { grain, .. }
            | Self::GrowthNotFollowed { grain, .. }
            | Self::GrainVanished { grain, .. } => Some(vec![*grain]),
            Self::CutInvalid(faults) | Self::RemeshInvalid(faults) | Self::Invalid(faults) => {
                let all: BTreeSet<GrainId> = faults.0.iter().flat_map(Fault::grains).collect();
                Some(all.into_iter().collect())
            }
            Self::GivenUp { last, .. } => last.grains(),
            Self::Folded { grains, .. } => Some(grains.clone()),
            Self::CutCrosses { .. } => Some(Vec::new()),
            _ => None,
        }
    }

    /// A grain misses its volume by a share of it; by all of it where it has none that is a number.
    pub(crate) fn volume_not_restored(grain: GrainId, relative_error: f64) -> Self {
        let relative_error = if relative_error.is_nan() { 1.0 } else { relative_error };
        Self::VolumeNotRestored { grain, relative_error }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What ways before the last said was dropped once.
    #[test]
    fn the_last_error_is_shown_and_all_are_kept() {
        let [first, second] = [2, 3].map(|count| NetworkError::Folded { count, grains: Vec::new() });
        let mut attempts = Vec::new();
        first.give_up("a", &mut attempts);
        let inner = second.after(attempts);
        assert!(inner.is_tangle() && inner.to_string().starts_with("3 edges"), "{inner}");
        let mut attempts = Vec::new();
        inner.give_up("b", &mut attempts);
        let last = NetworkError::VolumeNotRestored { grain: GrainId(1), relative_error: 0.5 };
        let all = last.after(attempts);
        assert_eq!(all.grains(), Some(vec![GrainId(1)]));
        let (attempts, last) = all.into_attempts();
        assert!(matches!(last, NetworkError::VolumeNotRestored { .. }), "{last}");
        let said = attempts.iter().map(|attempt| attempt.to_string()[..10].to_owned());
        assert_eq!(said.collect::<Vec<_>>(), ["a: 2 edges", "b: 3 edges"]);
    }
}
