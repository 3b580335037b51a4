//! The command line.

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::Shell;
use grainsmooth::{Coloring, Config, PeriodicCut, read_file_domain};
use polycrystal::{Relaxation, Volumes};
use voronoi::Dimension;

mod check;
mod config_file;
mod documents;
mod domain;
mod files;
mod measure;
pub mod mesh;
mod phases;
mod pictures;
mod run;
mod seeds;
mod sizes;
mod smoothing;
mod texture;
mod values;

pub use check::CheckArguments;
pub use documents::{print_completions, print_manual};
use domain::DomainArguments;
use files::FileArguments;
pub use measure::MeasureArguments;
use mesh::MeshArguments;
use phases::PhaseArguments;
use pictures::PictureArguments;
use run::RunArguments;
use seeds::SeedArguments;
use sizes::SizeArguments;
use smoothing::SmoothingArguments;
use texture::TextureArguments;

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
    phases: PhaseArguments,
    #[command(flatten)]
    domain: DomainArguments,
    #[command(flatten)]
    smoothing: SmoothingArguments,
    #[command(flatten)]
    texture: TextureArguments,
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
  grainsmooth --picture grains.png --explode 0.4  a picture of the grains, moved apart
  grainsmooth --report grains.html                a page with the grains to turn round, and their statistics
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
        let Self { seeds, sizes, phases, domain: arguments, smoothing, texture, files, pictures, .. } = self;
        let of_file = seeds.seeds_file.as_deref().map(read_file_domain).transpose()?.flatten();
        let domain = arguments.with_defaults_of(of_file);
        let periodic_cut = arguments.periodic_cut(domain.periodic);
        if periodic_cut == PeriodicCut::Box && files.has_series() {
            usage("--series shows whole grains; leave --periodic-cut box out");
        }
        if smoothing.volumes() == Volumes::Free && smoothing.relax == Some(Relaxation::Equilibrium) {
            usage(
                "--free lets grains grow for a time, and has no equilibrium; give one, such as --relax 0.3",
            );
        }
        let aspect_ratio = sizes.aspect_ratio(domain.dimension);
        let grain_shapes = sizes.grain_shapes.clone();
        if let Some(shapes) = &grain_shapes {
            if domain.periodic.any() {
                usage(
                    "--grain-shapes makes grains between walls; leave --periodic out, or give --aspect-ratio for grains that are all long one way",
                );
            }
            if let Err(message) = shapes.check(domain.dimension) {
                usage(message);
            }
        }
        let (sizes, phases, inside) = (sizes.options(), phases.options(), phases.inside());
        let coloring = pictures.coloring();
        if coloring == Coloring::Phase && phases.is_empty() {
            usage("--color-by phase needs phases; give some with --phase");
        }
        let config = Config {
            seeds: seeds.source(domain.dimension),
            random_seed: seeds.rng_seed,
            sizes,
            phases,
            inside,
            lloyd_steps: seeds.lloyd,
            dimension: domain.dimension,
            box_size: domain.box_size,
            shape: arguments.shape(&domain),
            aspect_ratio,
            grain_shapes,
            face_mesh: smoothing.face_mesh(),
            periodic: domain.periodic,
            periodic_cut,
            relaxation: Relaxation::default(),
            wall_tension: smoothing.wall_tension,
            tensions: smoothing.tension.clone(),
            mobilities: smoothing.mobility.clone(),
            volumes: smoothing.volumes(),
            regularize: smoothing.regularize,
            levels: smoothing.levels,
            junctions: smoothing.junctions(),
            drop_empty: seeds.drop_empty,
            min_diameter: seeds.min_diameter,
            texture: texture.options(),
            file: files.options(domain.dimension),
        };
        let relaxation = smoothing.relax.unwrap_or_else(|| config.usual_relaxation());
        let is_sized = config.is_sized();
        if !config.phases.is_empty() && config.min_diameter > 0.0 {
            usage(
                "--min-diameter would change the shares of the phases; cut small grains off with from=, or leave it out",
            );
        }
        if is_sized && config.min_diameter > 0.0 {
            usage(
                "--min-diameter would change sizes that are given; cut small ones off with from=, or give --seeding random",
            );
        }
        let is_of_cells =
            files.cells_csv.is_some() || files.cells_json.is_some() || self.run.no_mesh || files.has_series();
        if config.grain_shapes.is_none() && config.has_grains_of_several_cells() {
            if is_of_cells {
                usage(
                    "place= puts grains into others, which then are of several cells; leave --cells-csv, --cells-json, --no-mesh and --series out",
                );
            }
            if relaxation == Relaxation::Time(0.0) {
                usage(
                    "place= makes grains of several cells, which are sharp where these meet; leave --relax 0 out, or give --relax 0.02",
                );
            }
        }
        if relaxation == Relaxation::Time(0.0) && config.grain_shapes.is_some() {
            usage(
                "--grain-shapes makes grains of several cells, which are sharp where these meet; leave --relax 0 out, or give --relax 0.02",
            );
        }
        let config = Config { relaxation, ..config };
        if coloring.needs_texture() && !config.has_texture() {
            usage(&format!(
                "--color-by {} shows orientations; give the grains some, such as --texture random",
                coloring.name()
            ));
        }
        if let Some(gradient) = &config.sizes.gradient {
            if !is_sized {
                usage("--gradient changes given sizes; give --diameters or --seeding packed as well");
            }
            if gradient.axis == 2 && config.dimension == Dimension::Two {
                usage("--gradient along z needs three dimensions; with --dim 2 give x or y");
            }
        }
        if let Err(error) = config.check_phases() {
            usage(&error.to_string());
        }
        if let Err(error) = config.check_inside() {
            usage(&error.to_string());
        }
        if let Err(error) = config.check_laws() {
            usage(&error.to_string());
        }
        if texture.has_sample_symmetry() && !config.has_texture() {
            usage("--sample-symmetry is that of a texture; give --texture as well");
        }
        let is_count_open = config.has_sizes() && seeds.is_count_open();
        if is_count_open { config.with_count_of_sizes() } else { Ok(config) }
    }
}

/// Ends the program as clap does on a mistake.
pub fn usage(message: &str) -> ! {
    Arguments::command().error(ErrorKind::WrongNumberOfValues, message).exit()
}
