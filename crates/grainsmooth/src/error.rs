use std::io;
use std::path::{Path, PathBuf};

use glam::DVec3;
use polycrystal::{Faults, NetworkError};
use voronoi::volumes::{PlaceError, VolumesError};
use voronoi::{Dimension, VoronoiError};

use crate::config::check::ConfigError;
use crate::config::inside::InsideError;
use crate::config::laws::LawError;
use crate::config::phases::PhasesError;
use crate::memory::{self, MemoryError};

pub(crate) mod failed_grain;
pub(crate) mod failure;
pub(crate) mod map_file;
pub(crate) mod mesh_file;
pub(crate) mod seed_file;
pub(crate) mod usage;

use failure::Failure;
use map_file::MapProblem;
use mesh_file::MeshFileProblem;
use seed_file::{SeedPlace, SeedProblem};
use usage::UsageError;

/// What can go wrong between the user's input and the files written. Each message is one line that names the
/// value, the place and the remedy.
///
/// The message holds the cause, so `source` names none: whoever prints the chain would print it twice.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The output path has no extension, or one that names no format.
    #[error("{}: unknown extension; name the file {known}", path.display())]
    UnknownExtension {
        /// The path as given.
        path: PathBuf,
        /// The extensions that name one.
        known: String,
    },
    /// The output's format cannot hold grains of this dimension.
    #[error(
        "{}: this format holds {} only; choose another, such as .vtp", path.display(),
        if *dimension == Dimension::Two { "2D grains" } else { "3D grains" }
    )]
    FormatDimension {
        /// The path as given.
        path: PathBuf,
        /// The dimension that the format holds.
        dimension: Dimension,
    },
    /// The output's format holds voxels, and nothing says how many.
    #[error("{}: this format holds voxels; give their number with --voxels NX NY NZ (NX NY in 2D)", path.display())]
    NoVoxels {
        /// The path as given.
        path: PathBuf,
    },
    /// Triangles fill grains in the plane, and nothing says how large.
    #[error(
        "{}: in 2D, triangles that fill grains have a size; give --elements-per-grain or --element-size{}", path.display(),
        if path.extension().is_some_and(|extension| extension == "inp") { ", or --voxels NX NY" } else { "" }
    )]
    NoElementSize {
        /// The path as given.
        path: PathBuf,
    },
    /// A file of voxels is larger than what is free where it is to go.
    #[error(
        "{}: would take {} and {} are free there; use fewer voxels or choose another path",
        path.display(), memory::in_words(*needed), memory::in_words(u128::from(*available))
    )]
    OutputExceedsDisk {
        /// The path as given.
        path: PathBuf,
        /// Bytes of the file.
        needed: u128,
        /// Bytes that there are.
        available: u64,
    },
    /// Two outputs are to have one path.
    #[error("{}: two outputs have this path; give each a path of its own", path.display())]
    OutputTwice {
        /// The path as given.
        path: PathBuf,
    },
    /// The directory that the output shall go to does not exist.
    #[error("{}: no directory {}; create it or choose another path", path.display(), directory.display())]
    NoOutputDirectory {
        /// The path as given.
        path: PathBuf,
        /// The missing directory.
        directory: PathBuf,
    },
    /// The output path is taken by something that is not a regular file.
    #[error("{}: is not a regular file; choose another path", path.display())]
    OutputNotAFile {
        /// The path as given.
        path: PathBuf,
    },
    /// The directory for files of grains is not empty, or is no directory.
    #[error("{}: is not an empty directory; remove it or choose another path", path.display())]
    OutputDirectoryTaken {
        /// The path as given.
        path: PathBuf,
    },
    /// Nothing can be written under the output path.
    #[error("{}: cannot be written: {cause}; make it writable or choose another path", path.display())]
    OutputNotWritable {
        /// The path as given.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
    /// Writing the output failed on the way; nothing of it is left behind.
    #[error("{}: writing failed and left nothing: {cause}{}", path.display(), remedy(cause))]
    WriteOutput {
        /// The path as given.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
    /// A file of input cannot be opened or read.
    #[error("{}: cannot be read: {cause}; give the path of a readable {kind}", path.display())]
    Unreadable {
        /// The path as given.
        path: PathBuf,
        /// What it should be: a file, or a text file.
        kind: &'static str,
        /// Why.
        cause: io::Error,
    },
    /// A seed file holds no seeds.
    #[error("{}: holds no seeds; give a file with one or more", path.display())]
    NoSeedsInFile {
        /// The path as given.
        path: PathBuf,
    },
    /// No point of a lattice lies in the domain.
    #[error(
        "no point of the lattice lies in the domain; use more unit cells along its shortest side, such as {more}"
    )]
    NoLatticeSeeds {
        /// More unit cells than were asked for.
        more: u32,
    },
    /// A place of a seed file holds no seed.
    #[error("{} {place}: {problem}", path.display())]
    BadSeed {
        /// The path as given.
        path: PathBuf,
        /// Where in the file.
        place: SeedPlace,
        /// What is wrong with it.
        problem: SeedProblem,
    },
    /// A side of the box is not a length that can be computed with.
    #[error("the box's side along {axis} is {length:?}; give a positive number between 1e-30 and 1e30")]
    BoxSide {
        /// `x`, `y` or `z`.
        axis: char,
        /// The side as given.
        length: f64,
    },
    /// A file's surface or half-spaces bound no domain.
    #[error("{}: {cause}", path.display())]
    DomainInFile {
        /// The path as given.
        path: PathBuf,
        /// What is wrong.
        cause: VoronoiError,
    },
    /// A half-space of a file bounds no domain.
    #[error("{} line {line}: {cause}", path.display())]
    HalfSpaceInFile {
        /// The path as given.
        path: PathBuf,
        /// Line of the file, counted from 1.
        line: usize,
        /// What is wrong.
        cause: VoronoiError,
    },
    /// A line of a file of half-spaces is none.
    #[error(
        "{} line {line}: write {} as numbers such as 0.5", path.display(),
        if *dimension == Dimension::Two { "nx, ny, d" } else { "nx, ny, nz, d" }
    )]
    BadHalfSpaceLine {
        /// The path as given.
        path: PathBuf,
        /// Line of the file, counted from 1.
        line: usize,
        /// What the file is read for.
        dimension: Dimension,
    },
    /// A seed of a file has no cell.
    #[error("{} {place}: {cause}", path.display())]
    SeedInFile {
        /// The path as given.
        path: PathBuf,
        /// Where in the file.
        place: SeedPlace,
        /// What is wrong with the seed.
        cause: VoronoiError,
    },
    /// Two seeds of a file stand at the same place.
    #[error(
        "{} {} and {}: the same seed ({}, {}, {}) twice; remove one of them",
        path.display(), places[0], places[1], position.x, position.y, position.z
    )]
    DuplicateSeedsInFile {
        /// The path as given.
        path: PathBuf,
        /// Where in the file.
        places: [SeedPlace; 2],
        /// The seeds' coordinates.
        position: DVec3,
    },
    /// Words that are no texture.
    #[error(transparent)]
    Texture(#[from] texture::SpecError),
    /// A measured map has crystals of another symmetry than is asked for.
    #[error(
        "{}: its crystals are {of_file} and not {asked}; give {option}{of_file}", path.display()
    )]
    TextureSymmetry {
        /// The path as given.
        path: PathBuf,
        /// What the file says.
        of_file: texture::CrystalSymmetry,
        /// What is asked for.
        asked: texture::CrystalSymmetry,
        /// What asks for another, before its name.
        option: &'static str,
    },
    /// The output's format holds orientations, and there are none.
    #[error("{}: this format holds orientations, but the grains have none; give them some, such as --texture random, or choose another", path.display())]
    NoTexture {
        /// The path as given.
        path: PathBuf,
    },
    /// The output's format holds convex cells, and grains are none.
    #[error("{}: this format holds convex cells, but grains of --grain-shapes, place= or a map are not convex; choose another, such as .vtp", path.display())]
    CellsOfGrains {
        /// The path as given.
        path: PathBuf,
    },
    /// A line of a file of sizes or orientations holds something else.
    #[error("{} line {line}: {problem}", path.display())]
    BadLine {
        /// The path as given.
        path: PathBuf,
        /// Line of the file, counted from 1.
        line: usize,
        /// What is wrong, and what to do about it.
        problem: String,
    },
    /// Grains of a phase have no place where they are to be.
    #[error(
        "{0}; give the phase a smaller share, fewer grains or another place, or more grains to the others"
    )]
    NoPlace(#[from] PlaceError),
    /// Grains that are put into others leave no room for one.
    #[error("the phases with place= are too crowded: {0}; give them smaller shares or smaller grains")]
    NoRoomAround(#[source] VolumesError),
    /// Options as the command line gives them, one mistaken, or which do not go together.
    #[error(transparent)]
    Usage(#[from] UsageError),
    /// Options that do not go together.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// Phases that do not go with the number of grains, or with given volumes.
    #[error(transparent)]
    Phases(#[from] PhasesError),
    /// Patterns inside grains that divide nothing.
    #[error(transparent)]
    Inside(#[from] InsideError),
    /// Laws by which all boundaries have no tension or mobility.
    #[error(transparent)]
    Law(#[from] LawError),
    /// A grain of the sizes asked for is larger than the domain.
    #[error(
        "a grain of diameter {diameter:.6} does not fit {of}; ask for diameters up to {fits:.6} (to={fits:.6} cuts larger ones off), or use a larger domain"
    )]
    GrainTooLarge {
        /// Its equivalent diameter.
        diameter: f64,
        /// What it does not fit.
        of: String,
        /// The largest that fits.
        fits: f64,
    },
    /// As many volumes as seeds are wanted.
    #[error("{asked}: {volumes} volumes for {seeds} seeds; give one for each")]
    VolumeCount {
        /// Where the volumes come from.
        asked: String,
        /// Number of volumes.
        volumes: usize,
        /// Number of seeds.
        seeds: usize,
    },
    /// Cells cannot have the volumes asked for.
    #[error(transparent)]
    Volumes(#[from] VolumesError),
    /// The seeds cannot be tessellated.
    #[error(transparent)]
    Voronoi(#[from] VoronoiError),
    /// Weights leave grains without volume.
    #[error(
        "weights leave {} without volume; change their radii, or drop them with --drop-empty",
        grains_in_words(grains)
    )]
    EmptyGrains {
        /// The grains, by number.
        grains: Vec<u32>,
    },
    /// The smooth network has too long edges for elements of the size that is asked for.
    #[error(
        "elements of {length:.3e} need a finer surface: its edges are {mean:.3e} long on average; give -n {levels}, or larger elements"
    )]
    CoarseReference {
        /// Mean length of the edges of the finest level.
        mean: f64,
        /// Length that elements are to have.
        length: f64,
        /// The number of levels that is enough.
        levels: u32,
    },
    /// Gmsh, which fills grains, is not there or too old.
    #[error(
        "cannot run gmsh, which fills grains with tetrahedra: {cause}; install version 4.8 or newer, such as with `apt install gmsh` or `pip install gmsh`"
    )]
    NoGmsh {
        /// What is wrong with it.
        cause: String,
    },
    /// A job pulls at sides of a box that no node is on.
    #[error(
        "{}: a job loads the sides of the box, but some have no node; leave --solver-deck out, or let the grains fill the box", path.display()
    )]
    NoSides {
        /// The path of the job.
        path: PathBuf,
    },
    /// Gmsh could not fill all grains.
    #[error(
        "Gmsh cannot fill {}: {cause}; give elements of another size with --elements-per-grain, or write each surface alone: the same command with --grains-dir surfaces in place of -o and of options of volume meshes",
        grains_in_words(grains)
    )]
    NotFilled {
        /// The grains, by number.
        grains: Vec<u32>,
        /// What it said of the first.
        cause: String,
    },
    /// The network cannot be made, relaxed, or is invalid.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// The same, with all that is known of it.
    #[error("{0}")]
    Failed(Box<Failure>),
    /// Short lines were to become points, and with elements of that size only a network that keeps them is valid.
    #[error("{0}; with --small-features keep, which leaves short lines as they are, it works")]
    WorksWithShortLines(NetworkError),
    /// A mesh file cannot be used.
    #[error("{}: {problem}", path.display())]
    MeshFile {
        /// The path as given.
        path: PathBuf,
        /// Why.
        problem: MeshFileProblem,
    },
    /// A measured map cannot be used.
    #[error("{}: {problem}", path.display())]
    MapFile {
        /// The path as given.
        path: PathBuf,
        /// Why.
        problem: MapProblem,
    },
    /// A map leads to no valid network.
    #[error("{}: {cause}", path.display())]
    NetworkOfMap {
        /// The path as given.
        path: PathBuf,
        /// Why.
        cause: Box<NetworkError>,
    },
    /// Grains of a map are so small and mixed that boundaries between them cross, or cannot keep the volumes.
    #[error(
        "{}: single voxels of different grains are too mixed for boundaries that keep apart and keep all volumes: {faults}; drop small grains with --min-voxels 4, or more",
        path.display()
    )]
    MixedVoxels {
        /// The path as given.
        path: PathBuf,
        /// What is wrong with the boundaries.
        faults: Faults,
    },
    /// Boundaries are folded before they relax, and do not get out of that.
    #[error(
        "{}: boundaries are folded in {folds} places, as where grains are thinner than three voxels, and cannot relax from there; leave out --relax, or give a finer map",
        path.display()
    )]
    RelaxesFolded {
        /// The path as given.
        path: PathBuf,
        /// Number of pairs of elements that are folded.
        folds: usize,
        /// What relaxation said.
        #[source]
        cause: Box<NetworkError>,
    },
    /// A collection of files (.pvd, .vtm) names none.
    #[error("{}: names no files; give a collection as ParaView writes it, or the files themselves", path.display())]
    EmptyCollection {
        /// The path as given.
        path: PathBuf,
    },
    /// Blocks without a network.
    #[error("{}: has no block \"boundaries\"; give the file of the network itself, *.vtp, *.vtu or *.vtk", path.display())]
    NoBoundariesBlock {
        /// The path as given.
        path: PathBuf,
    },
    /// A server cannot listen at a port of this machine.
    #[error("port {port} of 127.0.0.1: {cause}; give another --port, or leave it out to use a free one")]
    PortTaken {
        /// The port.
        port: u16,
        /// Why.
        cause: io::Error,
    },
    /// What is asked for does not fit.
    #[error(transparent)]
    Memory(#[from] MemoryError),
}

impl Error {
    /// The file that cannot be read or written and what the system says of it, where that is the error.
    pub fn file_cause(&self) -> Option<(&Path, &io::Error)> {
        match self {
            Self::OutputNotWritable { path, cause }
            | Self::WriteOutput { path, cause }
            | Self::Unreadable { path, cause, .. }
            | Self::MeshFile { path, problem: MeshFileProblem::Unreadable(cause) }
            | Self::MapFile { path, problem: MapProblem::Unreadable(cause) } => Some((path, cause)),
            _ => None,
        }
    }
}

/// What to do about a file that cannot be written. What a format cannot hold says so itself.
fn remedy(cause: &io::Error) -> &'static str {
    if cause.get_ref().is_some() { "" } else { "; make room or choose another path" }
}

/// Grains as a message names them, the first ten of many.
fn grains_in_words(grains: &[u32]) -> String {
    const NAMED: usize = 10;
    let names: Vec<String> = grains.iter().take(NAMED).map(u32::to_string).collect();
    let noun = if grains.len() == 1 { "grain" } else { "grains" };
    match grains.len().saturating_sub(NAMED) {
        0 => format!("{noun} {}", names.join(", ")),
        more => format!("{noun} {} and {more} more", names.join(", ")),
    }
}

impl From<Failure> for Error {
    fn from(failure: Failure) -> Self {
        Self::Failed(Box::new(failure))
    }
}
