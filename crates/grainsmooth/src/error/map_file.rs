//! What can be wrong with a measured map.

use std::io;

use voronoi::volumes::VolumesError;

/// Why a map of labels cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MapProblem {
    /// The file cannot be opened or read.
    #[error("cannot be read: {0}; give the path of a readable map")]
    Unreadable(io::Error),
    /// Another file, which holds the numbers, cannot be read.
    #[error("its numbers are in `{name}`, which cannot be read: {error}; put that file where the map says")]
    DataFile {
        /// The file as the map names it.
        name: String,
        /// Why not.
        error: io::Error,
    },
    /// The extension names no format.
    #[error("unknown extension; give a map {known}")]
    UnknownExtension {
        /// The extensions that are known.
        known: String,
    },
    /// The file ends too early, or is none of its format.
    #[error("{what}; give a complete {format} file")]
    Damaged {
        /// Name of the format.
        format: &'static str,
        /// What is wrong.
        what: String,
    },
    /// The file is good, and what it holds is no map that can be smoothed as it is.
    #[error("{what}; {remedy}")]
    Unfit {
        /// What stands against it.
        what: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// The file has no array with a whole number for each voxel.
    #[error("has no array with one whole number for each voxel; save the labels of grains as one")]
    NoLabels,
    /// The file lacks the array that is asked for.
    #[error("has no array `{name}` with one number for each voxel; name one that it has: {known}")]
    NoSuchArray {
        /// The name asked for.
        name: String,
        /// Those that it has.
        known: String,
    },
    /// Several arrays may be the labels.
    #[error("has several arrays that may be labels; choose one with --label-array: {known}")]
    SeveralArrays {
        /// Their names.
        known: String,
    },
    /// A label is no whole number of 32 bits.
    #[error("voxel {voxel} has the label {label}; labels are whole numbers from -2147483648 to 2147483647")]
    NotWhole {
        /// Number of the voxel, in the order of the file, from 0.
        voxel: usize,
        /// Its label.
        label: f64,
    },
    /// An array has not two or three indices.
    #[error("its array has {count} indices; a map has two or three")]
    Indices {
        /// How many.
        count: usize,
    },
    /// An option says what the file itself says.
    #[error("files of this format contain their {what}; leave {option} out")]
    Told {
        /// What the file tells.
        what: &'static str,
        /// The option.
        option: &'static str,
    },
    /// A file of numbers alone comes without their shape or type.
    #[error("holds only numbers; describe them with --shape NX NY NZ and --type, such as u16")]
    NumbersAlone,
    /// A file of numbers alone has another length.
    #[error("has {bytes} bytes; {voxels} voxels of {width} bytes take {expected}: correct --shape or --type")]
    Length {
        /// Bytes of the file.
        bytes: usize,
        /// Number of voxels asked for.
        voxels: usize,
        /// Bytes of each.
        width: usize,
        /// Bytes of all.
        expected: u128,
    },
    /// An image among the slices of a map cannot be used.
    #[error("{name}: {problem}")]
    Slice {
        /// The file's name.
        name: String,
        /// What is wrong with it.
        problem: Box<MapProblem>,
    },
    /// The images of a map's slices differ in size.
    #[error("{name} has {} x {} pixels, the first slice {} x {}; give slices of one size", size[0], size[1], first[0], first[1])]
    SliceSize {
        /// The file's name.
        name: String,
        /// Its pixels along x and y.
        size: [usize; 2],
        /// Those of the first slice.
        first: [usize; 2],
    },
    /// The map has no voxels.
    #[error("has no voxels along {axis}; give a map with at least one along each axis")]
    Empty {
        /// The axis.
        axis: char,
    },
    /// Voxels have no size.
    #[error("its voxels are {spacing} wide along {axis}; give their size with --spacing, such as 0.5")]
    Spacing {
        /// The axis.
        axis: char,
        /// Their width.
        spacing: f64,
    },
    /// The points of a map of orientations stand on no square or hexagonal grid.
    #[error("line {line}: the point {what}; give a map whose points lie on one square or hexagonal grid")]
    NoGrid {
        /// The line, from 1.
        line: usize,
        /// What of its point is wrong.
        what: String,
    },
    /// A line of a text file is not understood.
    #[error("line {line}: {what}")]
    Line {
        /// The line, from 1.
        line: usize,
        /// What is wrong, and the remedy.
        what: String,
    },
    /// A point of a file that is no text is not understood.
    #[error("point {point}: {what}")]
    Point {
        /// The point, from 1.
        point: usize,
        /// What is wrong, and the remedy.
        what: String,
    },
    /// The symmetry of crystals is not known.
    #[error("does not give the symmetry of {phase}; give it with --crystal-symmetry, such as cubic")]
    NoSymmetry {
        /// Name of the phase.
        phase: String,
    },
    /// An option is for another kind of map.
    #[error("is {kind}; leave {option} out")]
    OtherKind {
        /// What the map is.
        kind: &'static str,
        /// The option.
        option: &'static str,
    },
    /// A part of the map is asked for that it does not have.
    #[error("has {count} voxels along {axis}; --crop asks for {first}:{end}; give a part of 0:{count}")]
    Crop {
        /// The axis.
        axis: char,
        /// Number of voxels along it.
        count: usize,
        /// The first voxel asked for.
        first: usize,
        /// The first one behind.
        end: usize,
    },
    /// A network is elsewhere than the map that it is compared with.
    #[error(
        "its grains fill {place}, those of {network} {other}; give --spacing, --crop or --exterior-label so that they agree"
    )]
    Elsewhere {
        /// Where the grains of the map are.
        place: String,
        /// The file of the network.
        network: String,
        /// Where its grains are.
        other: String,
    },
    /// No power diagram has the volumes of the grains at their centroids.
    #[error("cells cannot be fitted to its grains, leave --fit-cells out: {0}")]
    NoCells(VolumesError),
    /// No grain is left.
    #[error(
        "has no grain of {least} or more voxels besides the exterior; lower --min-voxels, or correct --exterior-label"
    )]
    NoGrain {
        /// Least number of voxels.
        least: u64,
    },
}
