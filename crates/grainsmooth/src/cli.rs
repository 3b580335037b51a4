//! The command line.

use std::fmt::Display;
use std::num::NonZeroU32;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand, ValueEnum};
use glam::{BVec3, DVec3};
use grainsmooth::vtk::VtkFormat;
use grainsmooth::{
    Config, FileOptions, Lattice, Names, OutputDirectory, OutputFormat, SeedSource, StlEncoding,
};
use polycrystal::{FaceMesh, Junctions, Relaxation};
use voronoi::Dimension;

use crate::check_run::CheckArguments;
use crate::mesh_cli::MeshArguments;

/// Make a virtual polycrystal: smooth, closed grains of exact volume, as a VTK file for ParaView.
///
/// Random seeds grow into Voronoi grains. Relaxation then moves the grain boundaries toward the equilibrium of their
/// tension (120 degrees at triple lines) while every grain keeps its volume, and Loop subdivision makes them smooth.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 100, after_help = EXAMPLES)]
#[command(args_conflicts_with_subcommands = true)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Option<Command>,

    /// Number of grains, grown from random seeds
    #[arg(long, value_name = "N", default_value_t = 200_u32, value_parser = whole_number(1..=4_000_000_000_u32), allow_negative_numbers = true, help_heading = SEEDS)]
    seeds: u32,

    /// Random seeds uniform (random), or at least 0.75 mean spacings apart (poisson-disc)
    #[arg(long, value_enum, default_value_t = Seeding::Random, help_heading = SEEDS)]
    seeding: Seeding,

    /// Seeds on a lattice instead: sc, bcc, fcc or hcp (square or hex in 2D), with N unit cells along the shortest side
    #[arg(long, value_names = ["LATTICE", "N"], num_args = 2, value_parser = parse_lattice, allow_negative_numbers = true, conflicts_with_all = ["seeds", "rng_seed", "seeding"], help_heading = SEEDS)]
    lattice: Option<Vec<LatticeValue>>,

    /// Read seeds from a text file instead: x, y, z on each line (x, y in 2D); a last column radius weights the cells
    #[arg(long, value_name = "FILE", conflicts_with_all = ["seeds", "rng_seed", "seeding", "lattice"], help_heading = SEEDS)]
    seeds_file: Option<PathBuf>,

    /// Go on without seeds whose neighbours outweigh them; else that is an error
    #[arg(long, requires = "seeds_file", help_heading = SEEDS)]
    drop_empty: bool,

    /// Even out the grains: move every seed to the centroid of its cell, N times
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = whole_number(0..=100_000_u32), allow_negative_numbers = true, help_heading = SEEDS)]
    lloyd: u32,

    /// Start of the random generator: the same number gives the same grains on every machine
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = whole_number(0..=u64::MAX), allow_negative_numbers = true, help_heading = SEEDS)]
    rng_seed: u64,

    /// Dimensions: 3 for grains in a box, 2 for grains in a rectangle
    #[arg(long, value_name = "2|3", default_value = "3", value_parser = parse_dimension, help_heading = DOMAIN)]
    dim: Dimension,

    /// Side lengths of the box in your unit of length, X Y in 2D; a corner is at 0 0 0 [default: 1 1 1]
    #[arg(long = "box", value_names = ["X", "Y", "Z"], num_args = 2.., value_parser = parse_length, allow_negative_numbers = true, help_heading = DOMAIN)]
    box_size: Option<Vec<f64>>,

    /// Axes along which the box repeats, such as x,y,z: grains are whole there and grow through the walls
    #[arg(long, value_name = "AXES", value_parser = parse_axes, help_heading = DOMAIN)]
    periodic: Option<BVec3>,

    /// Control points inside boundaries: a fan of triangles round one in the middle (fan), or none (plain)
    #[arg(long, value_enum, default_value_t = FaceRule::Fan, help_heading = SMOOTHING)]
    faces: FaceRule,

    /// Refine the control mesh instead until no edge is longer than H, in the unit of --box; a grain is about as wide as the
    /// cube root of its volume
    #[arg(long, value_name = "H", value_parser = parse_edge_length, allow_negative_numbers = true, conflicts_with = "faces", help_heading = SMOOTHING)]
    edge_length: Option<f64>,

    /// Relaxation time, in units of the mean grain size squared, or `equilibrium`; 0 keeps boundaries flat
    #[arg(long, value_name = "T", default_value = "0.3", value_parser = parse_relaxation, allow_negative_numbers = true, help_heading = SMOOTHING)]
    relax: Relaxation,

    /// Length, in units of the mean grain size, below which edges between grains collapse; 0 keeps all
    /// [default: 0.1, but 0 with --relax 0]
    #[arg(long, value_name = "L", value_parser = parse_regularize, allow_negative_numbers = true, help_heading = SMOOTHING)]
    regularize: Option<f64>,

    /// Number of subdivisions; each makes four triangles of one (two segments in 2D)
    #[arg(short = 'n', long, value_name = "LEVELS", default_value_t = Config::default().levels, value_parser = whole_number(0..=99_u32), allow_negative_numbers = true, help_heading = SMOOTHING)]
    levels: u32,

    /// Triple lines as smooth curves (crease) or as polylines through all their control points (corner)
    #[arg(long, value_enum, default_value_t = JunctionRule::Crease, help_heading = SMOOTHING)]
    junctions: JunctionRule,

    /// File to write; its extension names the format: .vtp, .vtu, .vtk, .vtm, .stl, .ply, .obj, .msh (Gmsh), .fe (Surface Evolver),
    /// .tess (Neper), and voxels .vti (DAMASK), .npy, .ang
    #[arg(short, long, value_name = "PATH", default_value = "grains.vtp", value_parser = parse_output, help_heading = FILES)]
    pub output: PathBuf,

    /// Write each grain as a closed surface of its own into this new directory
    #[arg(long, value_name = "DIR", help_heading = FILES)]
    pub grains_dir: Option<PathBuf>,

    /// Format of the grains' own files
    #[arg(long, value_name = "FORMAT", value_enum, default_value_t = GrainFormat::Vtp, requires = "grains_dir", help_heading = FILES)]
    pub grains_format: GrainFormat,

    /// Number of voxels along each axis for .vti, .npy and .ang, X Y in 2D
    #[arg(long, value_names = ["NX", "NY", "NZ"], num_args = 2.., value_parser = whole_number(1..=65_536_u32), allow_negative_numbers = true, help_heading = FILES)]
    voxels: Option<Vec<u32>>,

    /// Write STL as text
    #[arg(long, help_heading = FILES)]
    ascii: bool,

    /// Names and numbers of arrays as another tool expects them
    #[arg(long, value_name = "TOOL", value_enum, default_value_t = NameScheme::Grainsmooth, help_heading = FILES)]
    names: NameScheme,

    /// Write a table of the flat cells as JSON
    #[arg(long, value_name = "PATH", help_heading = RUN)]
    pub cells_json: Option<PathBuf>,

    /// Write a table of the flat cells as CSV
    #[arg(long, value_name = "PATH", help_heading = RUN)]
    pub cells_csv: Option<PathBuf>,

    /// Stop after the cells and their tables: no relaxation, no mesh
    #[arg(long, conflicts_with = "output", help_heading = RUN)]
    pub no_mesh: bool,

    /// Number of threads [default: all processors]; the file does not depend on it
    #[arg(long, value_name = "N", value_parser = whole_number(1..=1024_u16), allow_negative_numbers = true, help_heading = RUN)]
    pub threads: Option<u16>,

    /// Say nothing unless something is wrong
    #[arg(short, long, help_heading = RUN)]
    pub quiet: bool,
}

/// What else the program does.
#[derive(Debug, Subcommand)]
pub enum Command {
    Mesh(MeshArguments),
    Check(CheckArguments),
}

const SEEDS: &str = "Seeds";
const DOMAIN: &str = "Domain";
const SMOOTHING: &str = "Smoothing";
const FILES: &str = "Files";
const RUN: &str = "Run";

const EXAMPLES: &str = "\
Examples:
  grainsmooth --seeds 200 -n 3                    200 grains in a unit cube, to grains.vtp
  grainsmooth --seeds 500 --box 3 1 0.2 -o a.vtu  a plate
  grainsmooth --seeds 300 --dim 2                 grains in a square
  grainsmooth --periodic x,y,z                    grains that fill space by repeating the cube
  grainsmooth --lattice bcc 4                     Kelvin's foam: 128 truncated octahedra, cut by the walls
  grainsmooth --seeds-file seeds.csv --relax 0    flat Voronoi grains from your own seeds

Exit status: 0 good, 1 the run failed or its result is invalid, 2 a mistake on the command line.";

/// `--seeding` as it is spelled.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Seeding {
    Random,
    PoissonDisc,
}

/// One of the two values of `--lattice`.
#[derive(Debug, Clone, Copy)]
enum LatticeValue {
    Kind(Lattice),
    Cells(u32),
}

/// `--faces` as it is spelled.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum FaceRule {
    Fan,
    Plain,
}

/// `--junctions` as it is spelled.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum JunctionRule {
    Crease,
    Corner,
}

/// `--grains-format` as it is spelled.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum GrainFormat {
    Vtp,
    Stl,
    Ply,
    Obj,
}

impl GrainFormat {
    /// The directory for files of this format, found fit to be made.
    pub fn check(self, path: &Path) -> Result<OutputDirectory, grainsmooth::Error> {
        OutputDirectory::check(path, self.into())
    }
}

impl From<GrainFormat> for OutputFormat {
    fn from(format: GrainFormat) -> Self {
        match format {
            GrainFormat::Vtp => Self::Vtk(VtkFormat::Vtp),
            GrainFormat::Stl => Self::Stl,
            GrainFormat::Ply => Self::Ply,
            GrainFormat::Obj => Self::Obj,
        }
    }
}

/// `--names` as it is spelled.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum NameScheme {
    Grainsmooth,
    Dream3d,
    Pyvista,
    Virmat,
    Neper,
}

impl Arguments {
    /// What the arguments ask to compute.
    ///
    /// Ends the program with exit status 2 where they do not fit together.
    pub fn config(&self) -> Config {
        let seeds = self.seed_source();
        let box_size = match (self.box_size.as_deref(), self.dim) {
            (None, _) => DVec3::ONE,
            (Some(&[x, y]), Dimension::Two) => DVec3::new(x, y, 1.0),
            (Some(&[x, y, z]), Dimension::Three) => DVec3::new(x, y, z),
            (Some(sides), Dimension::Two) => {
                usage(&format!("--box takes two numbers, X Y, with --dim 2; {} given", sides.len()))
            }
            (Some(sides), Dimension::Three) => {
                usage(&format!("--box takes three numbers, X Y Z, without --dim 2; {} given", sides.len()))
            }
        };
        let junctions = match self.junctions {
            JunctionRule::Crease => Junctions::Crease,
            JunctionRule::Corner => Junctions::Corner,
        };
        let face_mesh = match (self.edge_length, self.faces) {
            (Some(edge_length), _) => FaceMesh::Refined { edge_length },
            (None, FaceRule::Fan) => FaceMesh::Fan,
            (None, FaceRule::Plain) => FaceMesh::Plain,
        };
        let periodic = self.periodic.unwrap_or(BVec3::FALSE);
        if periodic.z && self.dim == Dimension::Two {
            usage("--periodic z needs three dimensions; with --dim 2 give x, y or x,y");
        }
        Config {
            seeds,
            random_seed: self.rng_seed,
            lloyd_steps: self.lloyd,
            dimension: self.dim,
            box_size,
            face_mesh,
            periodic,
            relaxation: self.relax,
            // What is not relaxed shall stay flat, for which no vertex may move.
            regularize: self.regularize.unwrap_or(if self.relax == Relaxation::Time(0.0) {
                0.0
            } else {
                Config::REGULARIZE
            }),
            levels: self.levels,
            junctions,
            drop_empty: self.drop_empty,
            file: self.file_options(),
        }
    }

    fn file_options(&self) -> FileOptions {
        let voxels = match (self.voxels.as_deref(), self.dim) {
            (None, _) => None,
            (Some(&[x, y]), Dimension::Two) => Some([x, y, 1]),
            (Some(&[x, y, z]), Dimension::Three) => Some([x, y, z]),
            (Some(counts), Dimension::Two) => {
                usage(&format!("--voxels takes two numbers, NX NY, with --dim 2; {} given", counts.len()))
            }
            (Some(counts), Dimension::Three) => usage(&format!(
                "--voxels takes three numbers, NX NY NZ, without --dim 2; {} given",
                counts.len()
            )),
        };
        let names = match self.names {
            NameScheme::Grainsmooth => Names::Grainsmooth,
            NameScheme::Dream3d => Names::Dream3d,
            NameScheme::Pyvista => Names::Pyvista,
            NameScheme::Virmat => Names::Virmat,
            NameScheme::Neper => Names::Neper,
        };
        let stl = if self.ascii { StlEncoding::Ascii } else { StlEncoding::Binary };
        let at_least_one = |count| NonZeroU32::new(count).unwrap_or(NonZeroU32::MIN);
        FileOptions { names, voxels: voxels.map(|counts| counts.map(at_least_one)), stl }
    }

    fn seed_source(&self) -> SeedSource {
        if let Some(path) = &self.seeds_file {
            return SeedSource::File(path.clone());
        }
        let count = self.seeds as usize;
        match (self.lattice.as_deref(), self.seeding) {
            (None, Seeding::Random) => SeedSource::Random { count },
            (None, Seeding::PoissonDisc) => SeedSource::PoissonDisc { count },
            (Some(&[LatticeValue::Kind(lattice), LatticeValue::Cells(cells)]), _) => {
                match (lattice.dimension(), self.dim) {
                    (Dimension::Three, Dimension::Two) => usage("--dim 2 has the lattices square and hex"),
                    (Dimension::Two, Dimension::Three) => {
                        usage("the lattices square and hex are for --dim 2; give sc, bcc, fcc or hcp")
                    }
                    _ => SeedSource::Lattice { lattice, cells },
                }
            }
            (Some(_), _) => usage("--lattice takes a lattice and the number of its cells, such as bcc 4"),
        }
    }
}

/// Ends the program as clap does on a mistake.
fn usage(message: &str) -> ! {
    Arguments::command().error(ErrorKind::WrongNumberOfValues, message).exit()
}

fn whole_number<T>(range: RangeInclusive<T>) -> impl Fn(&str) -> Result<T, String> + Clone
where
    T: FromStr + PartialOrd + Display + Clone,
{
    move |text| {
        let number = text.parse().ok().filter(|number| range.contains(number));
        number.ok_or_else(|| format!("give a whole number from {} to {}", range.start(), range.end()))
    }
}

fn parse_lattice(text: &str) -> Result<LatticeValue, String> {
    if let Some(lattice) = Lattice::ALL.into_iter().find(|lattice| lattice.name() == text) {
        return Ok(LatticeValue::Kind(lattice));
    }
    // A cube of so many cells has as many seeds as ids can name.
    let cells = whole_number(1..=1600_u32)(text).map(LatticeValue::Cells);
    cells.map_err(|remedy| {
        format!("the lattices are sc, bcc, fcc and hcp, and square and hex in 2D; then {remedy}")
    })
}

fn parse_dimension(text: &str) -> Result<Dimension, String> {
    match text {
        "2" => Ok(Dimension::Two),
        "3" => Ok(Dimension::Three),
        _ => Err("grains have 2 or 3 dimensions".to_owned()),
    }
}

fn parse_length(text: &str) -> Result<f64, String> {
    let length = text.parse().ok().filter(|length| Config::SIDE_RANGE.contains(length));
    length.ok_or_else(|| "a side of the box is a positive number between 1e-30 and 1e30".to_owned())
}

fn parse_edge_length(text: &str) -> Result<f64, String> {
    let length = text.parse().ok().filter(|length| Config::SIDE_RANGE.contains(length));
    length.ok_or_else(|| "an edge length is a positive number between 1e-30 and 1e30".to_owned())
}

fn parse_axes(text: &str) -> Result<BVec3, String> {
    let mut axes = [false; 3];
    let known =
        text.split(',').all(|name| match ["x", "y", "z"].iter().position(|axis| *axis == name.trim()) {
            Some(axis) => !std::mem::replace(&mut axes[axis], true),
            None => false,
        });
    if known {
        Ok(axes.into())
    } else {
        Err("name each axis once, with commas between: x, y, z, x,y or x,y,z".to_owned())
    }
}

fn parse_relaxation(text: &str) -> Result<Relaxation, String> {
    if text == "equilibrium" {
        return Ok(Relaxation::Equilibrium);
    }
    let time = text.parse().ok().filter(|time: &f64| time.is_finite() && *time >= 0.0);
    let time = time.ok_or_else(|| {
        "the relaxation time is 0 (off) or a positive, finite number, or equilibrium".to_owned()
    });
    time.map(Relaxation::Time)
}

fn parse_regularize(text: &str) -> Result<f64, String> {
    let length = text.parse().ok().filter(|length| (0.0..=Config::LARGEST_REGULARIZE).contains(length));
    length.ok_or_else(|| format!("give a length from 0 (off) to {}", Config::LARGEST_REGULARIZE))
}

fn parse_output(text: &str) -> Result<PathBuf, String> {
    let path = Path::new(text);
    match OutputFormat::of_path(path) {
        Some(_) => Ok(path.to_owned()),
        None => Err(format!("unknown extension; name the file {}", OutputFormat::known_extensions())),
    }
}
