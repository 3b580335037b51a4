//! The command line.

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::Shell;
use grainsmooth::{Coloring, Config, PeriodicCut, SizeOptions, read_file_domain};

mod check;
mod config_file;
mod documents;
mod domain;
mod files;
mod measure;
pub mod mesh;
mod page;
mod pictures;
mod run;
mod seeds;
mod sizes;
mod smooth;
mod smoothing;

pub use check::CheckArguments;
pub use documents::{print_completions, print_manual};
use domain::DomainArguments;
use files::FileArguments;
pub use files::OutputArguments;
pub use measure::MeasureArguments;
use mesh::MeshArguments;
pub use page::{EditArguments, ServerArguments, ViewArguments};
pub use pictures::PictureArguments;
use run::RunArguments;
pub use run::SharedArguments;
use seeds::SeedArguments;
use sizes::SizeArguments;
pub use smooth::SmoothArguments;
use smoothing::SmoothingArguments;

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
    #[command(flatten)]
    seeds: SeedArguments,
    #[command(flatten)]
    sizes: SizeArguments,
    #[command(flatten)]
    domain: DomainArguments,
    #[command(flatten)]
    smoothing: SmoothingArguments,
    #[command(flatten)]
    config: Config,
    #[command(flatten)]
    pub files: FileArguments,
    #[command(flatten)]
    pub pictures: PictureArguments,
    #[command(flatten)]
    pub run: RunArguments,
}

/// What else the program does.
#[derive(Debug, Subcommand)]
pub enum Command {
    Mesh(MeshArguments),
    Check(CheckArguments),
    Measure(MeasureArguments),
    Smooth(SmoothArguments),
    View(ViewArguments),
    Edit(EditArguments),
    /// Print what completes options and values in a shell
    ///
    /// Example: grainsmooth completions bash > ~/.local/share/bash-completion/completions/grainsmooth
    Completions {
        /// The shell
        shell: Shell,
    },
    /// Print the manual page
    ///
    /// Example: grainsmooth man | man -l -
    Man,
}

const EXAMPLES: &str = "\
Examples:
  grainsmooth --seeds 200 -n 3                    200 grains in a unit cube, to grains.vtp
  grainsmooth --seeds 500 --box 3 1 0.2 -o a.vtu  a plate
  grainsmooth --seeds 300 --dim 2                 grains in a square
  grainsmooth --domain sphere                     grains that fill a ball
  grainsmooth --periodic x,y,z                    grains that fill space by repeating the cube
  grainsmooth --lattice bcc 4                     Kelvin's foam: 128 truncated octahedra, cut by the walls
  grainsmooth --seeds-file seeds.csv --relax 0    flat Voronoi grains from your own seeds
  grainsmooth --picture grains.png --explode 0.4  a picture of the grains, exploded
  grainsmooth --report grains.html                a page with the grains to rotate, and their statistics
  grainsmooth measure sample.tess                 what a twin of a sample takes
  grainsmooth --config grains.vtp                 the run that wrote grains.vtp once more

Exit status: 0 good, 1 the run failed or its result is invalid, 2 a mistake on the command line.";

impl Arguments {
    /// The program's arguments, with the options of the file that `--config` names.
    ///
    /// Ends the program with exit status 2 where one is mistaken.
    pub fn read() -> Self {
        let arguments: Vec<_> = std::env::args_os().collect();
        match config_file::with_config_file(arguments, &Self::command()) {
            Ok(arguments) => Self::parse_from(arguments),
            Err(message) => Self::command().error(ErrorKind::ValueValidation, message).exit(),
        }
    }

    /// What the arguments ask to compute.
    ///
    /// Ends the program with exit status 2 where they do not fit together.
    ///
    /// # Errors
    /// When the file of the seeds cannot tell what they fill.
    pub fn config(&self) -> Result<Config, grainsmooth::Error> {
        let Self { seeds, sizes, domain: arguments, smoothing, config, files, .. } = self;
        let of_file = seeds.seeds_file.as_deref().map(read_file_domain).transpose()?.flatten();
        let domain = arguments.with_defaults_of(of_file);
        let config = Config {
            seeds: seeds.source(domain.dimension),
            sizes: SizeOptions { source: sizes.source(), ..config.sizes.clone() },
            dimension: domain.dimension,
            box_size: domain.box_size,
            aspect_ratio: sizes.aspect_ratio(domain.dimension),
            shape: arguments.shape(&domain),
            periodic: domain.periodic,
            face_mesh: smoothing.face_mesh(),
            volumes: smoothing.volumes(),
            file: files.outputs.options(domain.dimension),
            ..config.clone()
        };
        // Files say what was usual when they were written.
        let config = Config { relaxation: Some(config.effective_relaxation()), ..config };
        if let Err(error) = config.check() {
            usage(&error.to_string());
        }
        self.check_shown(&config);
        let is_count_open = config.has_sizes() && seeds.is_count_open();
        if is_count_open { config.with_count_of_sizes() } else { Ok(config) }
    }

    /// Checks that what is to be written and shown is there.
    fn check_shown(&self, config: &Config) {
        let Self { files, pictures, run, .. } = self;
        if config.periodic_cut == PeriodicCut::Box && files.has_series() {
            usage("--series shows whole grains; leave --periodic-cut box out");
        }
        let is_of_cells =
            files.cells_csv.is_some() || files.cells_json.is_some() || run.no_mesh || files.has_series();
        if is_of_cells && config.grain_shapes.is_none() && config.has_grains_of_several_cells() {
            usage(
                "place= puts grains into others, which then are of several cells; leave --cells-csv, --cells-json, --no-mesh and --series out",
            );
        }
        let coloring = pictures.coloring();
        if coloring == Coloring::Phase && config.phases.is_empty() {
            usage("--color-by phase needs phases; give some with --phase");
        }
        if coloring.needs_texture() && !config.has_texture() {
            usage(&format!(
                "--color-by {} shows orientations; give the grains some, such as --texture random",
                coloring.name()
            ));
        }
    }
}

/// Ends the program as clap does on a mistake.
pub fn usage(message: &str) -> ! {
    Arguments::command().error(ErrorKind::WrongNumberOfValues, message).exit()
}
