//! The command line of `grainsmooth measure`.

use std::path::PathBuf;

use crate::TableFormat;
use clap::Args;
use texture::{CrystalSymmetry, SymmetryError};
use voronoi::Dimension;

use super::domain::parse_dimension;

/// Measure the sizes, shapes, neighbours and texture of the grains of a sample, and print the command that makes a similar
/// one
///
/// Reads labelled networks (.vtp, .vtu, .vtk), Neper's tessellations (.tess), and tables of grains with a column diameter or
/// volume (.csv, .txt, .json). Diameters are equivalent diameters. The command uses the fitted distribution or, with --table, the measured diameters and orientations.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct MeasureArguments {
    /// File to measure: .vtp, .vtu, .vtk, .tess, .csv, .txt or .json
    #[arg(value_name = "FILE")]
    pub file: PathBuf,

    /// Report as JSON
    #[arg(long)]
    pub json: bool,

    /// Write the grains as a table (.csv), for --diameters and --texture
    ///
    /// Example: --table grains.csv
    #[arg(long, value_name = "PATH", value_parser = parse_table)]
    pub table: Option<PathBuf>,

    /// Symmetry of the crystals, if the file does not give it [default: cubic]
    ///
    /// Example: --crystal-symmetry hexagonal
    #[arg(long, value_name = "GROUP", value_parser = parse_symmetry, allow_hyphen_values = true)]
    pub crystal_symmetry: Option<CrystalSymmetry>,

    /// Dimension of the grains of a table whose columns do not show it
    ///
    /// Example: --dim 2
    #[arg(long, value_name = "2|3", value_parser = parse_dimension)]
    pub dim: Option<Dimension>,
}

const EXAMPLES: &str = "\
Examples:
  grainsmooth measure grains.vtp                           the twin's --diameters and --box
  grainsmooth measure sample.tess --table grains.csv       and the grains for --diameters grains.csv --texture grains.csv
  grainsmooth measure sections.csv --dim 2 --json          for programs

Exit status: 0 good, 1 the file is unreadable or no sample, 2 a mistake on the command line.";

fn parse_table(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match TableFormat::of_path(&path) {
        Some(TableFormat::Csv) => Ok(path),
        _ => Err("name the table *.csv".to_owned()),
    }
}

fn parse_symmetry(text: &str) -> Result<CrystalSymmetry, String> {
    text.parse().map_err(|error: SymmetryError| error.to_string())
}
