//! The command line.

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};
use grainsmooth::Config;

use crate::check_run::CheckArguments;
use crate::mesh_cli::MeshArguments;

mod config_file;
mod domain;
mod files;
mod run;
mod seeds;
mod smoothing;
mod values;

use domain::DomainArguments;
use files::FileArguments;
use run::RunArguments;
use seeds::SeedArguments;
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
    domain: DomainArguments,
    #[command(flatten)]
    smoothing: SmoothingArguments,
    #[command(flatten)]
    pub files: FileArguments,
    #[command(flatten)]
    pub run: RunArguments,
}

/// What else the program does.
#[derive(Debug, Subcommand)]
pub enum Command {
    Mesh(MeshArguments),
    Check(CheckArguments),
}

const EXAMPLES: &str = "\
Examples:
  grainsmooth --seeds 200 -n 3                    200 grains in a unit cube, to grains.vtp
  grainsmooth --seeds 500 --box 3 1 0.2 -o a.vtu  a plate
  grainsmooth --seeds 300 --dim 2                 grains in a square
  grainsmooth --periodic x,y,z                    grains that fill space by repeating the cube
  grainsmooth --lattice bcc 4                     Kelvin's foam: 128 truncated octahedra, cut by the walls
  grainsmooth --seeds-file seeds.csv --relax 0    flat Voronoi grains from your own seeds
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
    pub fn config(&self) -> Config {
        let Self { seeds, domain, smoothing, files, .. } = self;
        Config {
            seeds: seeds.source(domain.dim),
            random_seed: seeds.rng_seed,
            lloyd_steps: seeds.lloyd,
            dimension: domain.dim,
            box_size: domain.box_size(),
            face_mesh: smoothing.face_mesh(),
            periodic: domain.periodic(),
            relaxation_time: smoothing.relax,
            volumes: smoothing.volumes(),
            regularize: smoothing.regularize(),
            levels: smoothing.levels,
            junctions: smoothing.junctions(),
            drop_empty: seeds.drop_empty,
            file: files.options(domain.dim),
        }
    }
}

/// Ends the program as clap does on a mistake.
fn usage(message: &str) -> ! {
    Arguments::command().error(ErrorKind::WrongNumberOfValues, message).exit()
}
