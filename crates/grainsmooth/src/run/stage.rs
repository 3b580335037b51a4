//! The parts of a run, and how far it is.

use std::time::{Duration, Instant};

/// A part of a run, in the order in which they follow each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Reading a measured map.
    Map,
    /// Drawing or reading seeds.
    Seeds,
    /// Cutting the Voronoi cells.
    Cells,
    /// Building the network and the connectivity of all its levels.
    Network,
    /// Moving control points toward equilibrium.
    Relaxation,
    /// Placing the points of the finest level.
    Subdivision,
    /// Checking the result and measuring it.
    Validation,
    /// Giving boundaries triangles of a wanted size.
    Remeshing,
    /// Filling grains with tetrahedra.
    Filling,
    /// Writing the file.
    Writing,
}

impl Stage {
    /// The stage in one word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Map => "map",
            Self::Seeds => "seeds",
            Self::Cells => "cells",
            Self::Network => "network",
            Self::Relaxation => "relaxation",
            Self::Subdivision => "subdivision",
            Self::Validation => "validation",
            Self::Remeshing => "remeshing",
            Self::Filling => "filling",
            Self::Writing => "writing",
        }
    }
}

/// Told how far a run is: the stage, the steps of it that are done, and their number.
pub type Progress<'a> = &'a (dyn Fn(Stage, usize, usize) + Sync);

/// Runs stages one after the other and remembers how long each took.
pub(crate) struct Clock<'a> {
    pub(crate) progress: Progress<'a>,
    pub(crate) times: Vec<(Stage, Duration)>,
}

impl Clock<'_> {
    pub(crate) fn time<T>(&mut self, stage: Stage, work: impl FnOnce() -> T) -> T {
        (self.progress)(stage, 0, 1);
        let start = Instant::now();
        let result = work();
        let taken = start.elapsed();
        match self.times.iter_mut().find(|(known, _)| *known == stage) {
            Some((_, time)) => *time += taken,
            None => self.times.push((stage, taken)),
        }
        result
    }

    /// Counts some time of a stage to another.
    pub(crate) fn move_time(&mut self, time: Duration, from: Stage, to: Stage) {
        for (stage, taken) in &mut self.times {
            if *stage == from {
                *taken = taken.saturating_sub(time);
            }
        }
        match self.times.iter_mut().find(|(known, _)| *known == to) {
            Some((_, taken)) => *taken += time,
            None => self.times.push((to, time)),
        }
    }
}
