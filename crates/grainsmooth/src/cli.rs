//! The command line, of the program and of whoever gives its options in another way.

use std::ffi::OsString;
use std::path::Path;

use crate::error::usage::UsageError;
use crate::prelude::Dimension;
use crate::{
    Coloring, Config, Error, LabelledFile, PeriodicCut, Shape, SizeOptions, Slice, read_file_domain,
};
use clap::error::ErrorKind;
use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use clap_complete::Shell;
use toml::Table;
use voronoi::Domain;

mod check;
mod config_file;
mod documents;
mod domain;
mod files;
mod measure;
pub mod mesh;
mod option_value;
mod page;
mod pictures;
mod remesh;
mod result;
mod run;
mod seeds;
mod sizes;
mod smooth;
mod smoothing;

pub use check::CheckArguments;
pub use documents::{completions, manual};
use domain::DomainArguments;
use files::FileArguments;
pub use files::OutputArguments;
pub use measure::MeasureArguments;
use mesh::MeshArguments;
pub use option_value::OptionValue;
pub use page::{EditArguments, ServerArguments, ViewArguments};
pub use pictures::PictureArguments;
pub use remesh::RemeshArguments;
pub use result::ResultArguments;
use run::RunArguments;
pub use run::SharedArguments;
use seeds::SeedArguments;
use sizes::SizeArguments;
pub use smooth::SmoothArguments;
use smoothing::SmoothingArguments;

/// Make a virtual polycrystal: smooth, closed grains of exact volume, as a VTK file for ParaView.
///
/// Each seed becomes a convex cell; by default cells have the volumes of real grains, see --seeding. Relaxation then moves
/// their boundaries toward the equilibrium of tension (120 degrees at triple lines) while every grain keeps its volume, and
/// Loop subdivision makes them smooth.
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
    Smooth(Box<SmoothArguments>),
    Remesh(Box<RemeshArguments>),
    View(ViewArguments),
    Edit(EditArguments),
    /// Print a completion script for a shell
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
    /// The arguments of a command line, whose first word is the program's name, with the options of the file that `--config` names.
    ///
    /// # Errors
    /// [`Error::Usage`] where one is mistaken; also where `--help` or `--version` asks for what is no run.
    pub fn read(words: Vec<OsString>) -> Result<Self, Error> {
        let words = config_file::with_config_file(words, &Self::command()).map_err(invalid)?;
        Ok(Self::try_parse_from(words).map_err(UsageError::from)?)
    }

    /// The arguments that give options by their long names.
    ///
    /// # Errors
    /// [`Error::Usage`] where one is mistaken.
    pub fn of_options(options: &[(String, OptionValue)]) -> Result<Self, Error> {
        let mut command = Self::command();
        command.build();
        Self::of_words(option_value::all_words(options, &command))
    }

    /// The arguments of `smooth` for a map, with its options by their long names.
    ///
    /// # Errors
    /// [`Error::Usage`] where one is mistaken.
    pub fn of_smooth(map: &Path, options: &[(String, OptionValue)]) -> Result<SmoothArguments, Error> {
        let mut command = SmoothArguments::augment_args(clap::Command::new("smooth"));
        command.build();
        let words = option_value::all_words(options, &command).map_err(invalid)?.concat();
        let words = [vec!["smooth".into()], words, vec!["--".into(), map.into()]].concat();
        let matches = command.try_get_matches_from(words).map_err(UsageError::from)?;
        Ok(SmoothArguments::from_arg_matches(&matches).map_err(UsageError::from)?)
    }

    /// The arguments that settings tell, as TOML: those of a config, or of a file that was written.
    ///
    /// # Errors
    /// [`Error::Usage`] where one is mistaken.
    pub fn of_settings(settings: &str) -> Result<Self, Error> {
        let mut command = Self::command();
        command.build();
        let options = config_file::parse(settings, &command);
        Self::of_words(options.map(|options| options.into_iter().map(|(_, words)| words).collect()))
    }

    /// The body that grains of a network from a file fill, where that is no box and the file tells it.
    pub fn domain_of(file: &LabelledFile) -> Option<Domain> {
        let settings = file.settings.as_ref()?;
        let shape = ["dim", "box", "domain", "chord-error", "half-spaces"];
        let settings: Table =
            settings.clone().into_iter().filter(|(key, _)| shape.contains(&key.as_str())).collect();
        let config = Self::of_settings(&settings.to_string()).ok()?.config().ok()?;
        if config.shape == Shape::Box { None } else { config.domain().ok() }
    }

    fn of_words(words: Result<Vec<Vec<OsString>>, String>) -> Result<Self, Error> {
        let words = words.map_err(invalid)?.concat();
        Self::read([vec![env!("CARGO_PKG_NAME").into()], words].concat())
    }

    /// What the arguments ask to compute.
    ///
    /// # Errors
    /// [`Error::Usage`] where they do not fit together; when the file of the seeds cannot tell what they fill.
    pub fn config(&self) -> Result<Config, Error> {
        let Self { seeds, sizes, domain: arguments, smoothing, config, files, .. } = self;
        let of_file = seeds.seeds_file.as_deref().map(read_file_domain).transpose()?.flatten();
        let domain = arguments.with_defaults_of(of_file)?;
        let config = Config {
            seeds: seeds.source(domain.dimension)?,
            sizes: SizeOptions { source: sizes.source(), ..config.sizes.clone() },
            dimension: domain.dimension,
            box_size: domain.box_size,
            aspect_ratio: sizes.aspect_ratio(domain.dimension)?,
            shape: arguments.shape(&domain)?,
            periodic: domain.periodic,
            face_mesh: smoothing.face_mesh(),
            volumes: smoothing.volumes(),
            file: files.outputs.options(domain.dimension)?,
            ..config.clone()
        };
        // Files say what was usual when they were written.
        let config = Config { relaxation: Some(config.effective_relaxation()), ..config };
        config.check().map_err(|error| usage(&error.to_string()))?;
        self.check_shown(&config)?;
        let is_count_open = config.has_sizes() && seeds.is_count_open();
        if is_count_open { config.with_count_of_sizes() } else { Ok(config) }
    }

    /// Checks that what is to be written and shown is there.
    fn check_shown(&self, config: &Config) -> Result<(), Error> {
        let Self { files, pictures, run, .. } = self;
        if config.periodic_cut == PeriodicCut::Box && files.has_series() {
            return Err(usage("--series shows whole grains; leave --periodic-cut box out"));
        }
        if config.elements.are_asked() && files.has_series() {
            return Err(usage(
                "--series shows boundaries before they are remeshed; leave --element-size and --elements-per-grain out",
            ));
        }
        let is_of_cells =
            files.cells_csv.is_some() || files.cells_json.is_some() || run.no_mesh || files.has_series();
        if is_of_cells && config.grain_shapes.is_none() && config.has_grains_of_several_cells() {
            return Err(usage(
                "place= puts grains into others, which then are of several cells; leave --cells-csv, --cells-json, --no-mesh and --series out",
            ));
        }
        let coloring = pictures.coloring();
        if coloring == Coloring::Phase && config.phases.is_empty() {
            return Err(usage("--color-by phase needs phases; give some with --phase"));
        }
        if coloring.needs_texture() && !config.has_texture() {
            return Err(usage(&format!(
                "--color-by {} shows orientations; give the grains some, such as --texture random",
                coloring.name()
            )));
        }
        self.check_slice(config)
    }

    /// Checks that a picture's slice meets the box.
    fn check_slice(&self, config: &Config) -> Result<(), Error> {
        let Some(Slice { axis, at }) = self.pictures.slice() else { return Ok(()) };
        if config.dimension == Dimension::Two {
            return Err(usage("--slice cuts grains in space; leave it out with --dim 2"));
        }
        let (name, end) = (["x", "y", "z"][axis], config.box_size[axis] * config.stretch()[axis]);
        if (0.0..end).contains(&at) {
            return Ok(());
        }
        Err(usage(&format!(
            "--slice {name}={at} does not meet the box, which goes from 0 to {end} along {name}"
        )))
    }
}

/// The error of a value that an option cannot have.
fn invalid(message: String) -> UsageError {
    UsageError::from(Arguments::command().error(ErrorKind::ValueValidation, message))
}

/// The error of options that each are good, and together are not.
pub fn usage(message: &str) -> Error {
    UsageError::from(Arguments::command().error(ErrorKind::WrongNumberOfValues, message)).into()
}
