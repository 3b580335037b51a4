//! A run before it runs: its command line, its files, and what it promises.

use crate::options::Options;
use crate::outputs::Promise;

/// What a campaign keeps its runs to, so that they end in time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Most grains of a run.
    pub grains: u32,
    /// Triangles (in the plane: segments) of the finest level that are about the most.
    pub triangles: u32,
}

impl Limits {
    /// Of a campaign by hand.
    pub const USUAL: Self = Self { grains: 400, triangles: 400_000 };
}

/// What the angles of a run's triangles are counted with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AngleClass {
    /// Relaxed for a time, between walls.
    Walls,
    /// Relaxed for a time, periodic, grains whole.
    Periodic,
    /// Relaxed for a time, periodic, cut at the box.
    Cut,
    /// Relaxed to equilibrium, grains whole.
    Equilibrium,
    /// Grains of given shapes, several cells each.
    Shapes,
    /// Flat, or with short edges kept: triangles are as thin as the cells are.
    Unregularized,
    /// Remeshed with triangles of one size.
    Remeshed,
    /// In the plane, where there are no triangles.
    Plane,
    /// Of measured maps: where edges collapse, some triangles stay thin.
    Measured,
}

impl AngleClass {
    /// All classes, in a few words.
    pub const ALL: [(Self, &'static str); 9] = [
        (Self::Walls, "walls"),
        (Self::Periodic, "periodic"),
        (Self::Cut, "cut at the box"),
        (Self::Equilibrium, "equilibrium"),
        (Self::Shapes, "grain shapes"),
        (Self::Unregularized, "flat or not regularized"),
        (Self::Remeshed, "remeshed"),
        (Self::Plane, "plane"),
        (Self::Measured, "measured maps"),
    ];
}

/// What the network of a map promises.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MapPromise {
    /// The map's file or folder.
    pub name: String,
    /// The words that tell how it is read.
    pub options: Vec<String>,
    /// Whether the middle of every voxel lies in the grain of its label.
    pub is_exact: bool,
}

/// A run before it runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// How its seeds are placed, what its map is like, or the mistake.
    pub kind: String,
    /// Words before the options.
    pub command: Vec<String>,
    /// Options on the command line.
    pub options: Options,
    /// Files that stand in its directory beforehand: name and content.
    pub files: Vec<(String, Vec<u8>)>,
    /// The mistake's value, which the refusal has to name.
    pub mistake: Option<String>,
    /// What a good run leaves.
    pub promise: Promise,
    /// Whether relaxation keeps the volumes of the cells.
    pub keeps_volumes: bool,
    /// What it promises beside that, where it smooths a map.
    pub map: Option<MapPromise>,
    /// Two or three.
    pub dimension: usize,
    /// What its angles are counted with.
    pub angles: AngleClass,
}
