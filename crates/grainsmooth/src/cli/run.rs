//! Options about the run itself.

use std::path::PathBuf;

use clap::Args;

use crate::spelling::whole_number;

/// The run itself.
#[derive(Debug, Args)]
#[command(next_help_heading = "Run")]
pub struct RunArguments {
    /// Read options from a TOML file, or from a file that an earlier run wrote; options on the command line override them
    ///
    /// A key is the long name of an option, as in seeds = 500 or box = [2, 1, 1].
    ///
    /// Example: --config run.toml --rng-seed 2
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,

    /// Stop after the cells and their tables, without relaxation or mesh
    ///
    /// Example: --no-mesh --cells-csv cells.csv
    #[arg(long, conflicts_with_all = ["output", "stats", "series", "picture", "report", "dry_run", "json_summary"])]
    pub no_mesh: bool,

    /// Report how many grains, points and triangles there would be, and the file size and memory they need; write nothing
    ///
    /// Example: --seeds 100000 -n 3 --dry-run
    #[arg(long)]
    pub dry_run: bool,

    #[command(flatten)]
    pub shared: SharedArguments,
}

/// Options of every kind of run.
#[derive(Debug, Args)]
#[command(next_help_heading = "Run")]
pub struct SharedArguments {
    /// Write the summary as JSON, to a file or, with -, to standard output
    ///
    /// Example: --json-summary run.json
    #[arg(long, value_name = "PATH")]
    pub json_summary: Option<PathBuf>,

    /// Number of threads [default: all processors]; it does not change the result
    ///
    /// Example: --threads 4
    #[arg(long, value_name = "N", value_parser = whole_number(1..=1024_u16), allow_negative_numbers = true)]
    pub threads: Option<u16>,

    /// Print nothing unless something goes wrong
    ///
    /// Example: --quiet
    #[arg(short, long)]
    pub quiet: bool,
}
