//! Options about the files that are written.

use std::num::NonZeroU32;
use std::path::{Path, PathBuf};

use crate::spelling::{nearest, whole_number};
use crate::vtk::VtkEncoding;
use crate::{
    Error, FileOptions, Output, OutputFormat, SeriesOutput, StatisticsOutput, StlEncoding, TableFormat,
};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use voronoi::Dimension;

use super::usage;

/// Output of a network.
#[derive(Debug, Args)]
#[command(next_help_heading = "Files")]
pub struct OutputArguments {
    #[arg(short, long, help = output_help(), long_help = format!("{}\n\nExample: -o grains.vtp -o grains.msh", output_help()), value_name = "PATH", num_args = 1, default_value = "grains.vtp", value_parser = parse_output)]
    output: Vec<PathBuf>,

    /// Format for standard output, by its extension [default: vtp]
    ///
    /// Example: -o - --format ply
    #[arg(long, value_name = "FORMAT", value_parser = parse_format)]
    format: Option<OutputFormat>,

    /// Write each grain as a closed surface to its own file in this new directory
    ///
    /// Example: --grains-dir grains
    #[arg(long, value_name = "DIR")]
    pub grains_dir: Option<PathBuf>,

    /// Format of the files of --grains-dir
    ///
    /// Example: --grains-dir grains --grains-format stl
    #[arg(long, value_name = "FORMAT", value_parser = grain_formats(), default_value = "vtp", requires = "grains_dir")]
    pub grains_format: OutputFormat,

    /// Number of voxels along each axis, for formats that hold voxels; X Y in 2D [default with a map: those of the map]
    ///
    /// Example: --voxels 64 64 64 -o grains.vti
    #[arg(long, value_names = ["NX", "NY", "NZ"], num_args = 2.., value_parser = whole_number(1..=65_536_u32), allow_negative_numbers = true)]
    voxels: Option<Vec<u32>>,

    /// Write STL files as text
    ///
    /// Example: --ascii -o grains.stl
    #[arg(long)]
    ascii: bool,

    #[command(flatten)]
    options: FileOptions,

    #[command(flatten)]
    vtk: VtkArguments,

    /// Write measures of the smooth network: as JSON, or as CSV, with boundaries, lines and points in F.boundaries.csv and
    /// so on
    ///
    /// Example: --stats grains.json
    #[arg(long, value_name = "F", value_parser = parse_statistics)]
    stats: Option<PathBuf>,
}

/// Output.
#[derive(Debug, Args)]
#[command(next_help_heading = "Files")]
pub struct FileArguments {
    #[command(flatten)]
    pub outputs: OutputArguments,

    /// Write the relaxation as a time series for ParaView: F.pvd, with F_0000.vtp and so on beside it
    ///
    /// Example: --series relaxation.pvd --every 2
    #[arg(long, value_name = "F", value_parser = parse_series)]
    series: Option<PathBuf>,

    /// Write every K-th step of the relaxation
    ///
    /// Example: --series relaxation.pvd --every 2
    #[arg(long, value_name = "K", default_value_t = NonZeroU32::MIN, value_parser = parse_every, allow_negative_numbers = true, requires = "series")]
    pub every: NonZeroU32,

    /// Write a table of the flat cells as JSON
    ///
    /// Example: --cells-json cells.json
    #[arg(long, value_name = "PATH")]
    pub cells_json: Option<PathBuf>,

    /// Write a table of the flat cells as CSV
    ///
    /// Example: --cells-csv cells.csv
    #[arg(long, value_name = "PATH")]
    pub cells_csv: Option<PathBuf>,
}

/// What is asked of XML files of VTK, of networks and of meshes.
#[derive(Debug, Args)]
pub struct VtkArguments {
    /// How .vtp, .vtu, .vti and .vtm store numbers: raw is fastest; more programs read base64 and zlib
    ///
    /// Example: --vtk-encoding zlib -o grains.vtu
    #[arg(long, value_name = "ENCODING", value_enum, default_value_t)]
    pub vtk_encoding: VtkEncoding,
}

impl FileArguments {
    /// Whether a series is asked for.
    pub fn has_series(&self) -> bool {
        self.series.is_some()
    }

    /// Where a series goes, if one is asked for, found writable.
    pub fn series(&self) -> Result<Option<SeriesOutput>, Error> {
        self.series.as_deref().map(SeriesOutput::check).transpose()
    }
}

impl OutputArguments {
    /// Where statistics go, if they are asked for, found writable.
    pub fn statistics(&self, dimension: Dimension) -> Result<Option<StatisticsOutput>, Error> {
        let formats = self.stats.iter().filter_map(|path| Some((path, TableFormat::of_path(path)?)));
        let mut outputs = formats.map(|(path, format)| StatisticsOutput::check(path, format, dimension));
        outputs.next().transpose()
    }

    /// The files that the network goes to, found writable.
    pub fn outputs(&self) -> Result<Vec<Output>, Error> {
        self.output.iter().filter(|path| !is_standard_output(path)).map(Output::check).collect()
    }

    /// The format in which the network goes to standard output, if it does.
    ///
    /// # Errors
    /// [`Error::Usage`] where it cannot.
    pub fn standard_output(&self) -> Result<Option<OutputFormat>, Error> {
        let format = self.format.unwrap_or(OutputFormat::VTP);
        match self.output.iter().filter(|path| is_standard_output(path)).count() {
            0 if self.format.is_some() => {
                Err(usage("--format is for -o -; the extension of a file names its format"))
            }
            0 => Ok(None),
            1 if format.is_single_file() => Ok(Some(format)),
            1 => Err(usage(
                "standard output takes a single file; choose another format, such as vtp, or give a path",
            )),
            _ => Err(usage("two outputs go to standard output; give one of them a path")),
        }
    }

    /// How files are written of grains of a dimension.
    ///
    /// # Errors
    /// [`Error::Usage`] where the number of voxels is that of another dimension.
    pub fn options(&self, dimension: Dimension) -> Result<FileOptions, Error> {
        let voxels = match (self.voxels.as_deref(), dimension) {
            (None, _) => None,
            (Some(&[x, y]), Dimension::Two) => Some([x, y, 1]),
            (Some(&[x, y, z]), Dimension::Three) => Some([x, y, z]),
            (Some(counts), Dimension::Two) => {
                let count = counts.len();
                return Err(usage(&format!(
                    "--voxels takes two numbers, NX NY, with --dim 2; {count} given"
                )));
            }
            (Some(counts), Dimension::Three) => {
                let count = counts.len();
                return Err(usage(&format!(
                    "--voxels takes three numbers, NX NY NZ, without --dim 2; {count} given"
                )));
            }
        };
        let stl = if self.ascii { StlEncoding::Ascii } else { StlEncoding::Binary };
        let at_least_one = |count| NonZeroU32::new(count).unwrap_or(NonZeroU32::MIN);
        let voxels = voxels.map(|counts| counts.map(at_least_one));
        Ok(FileOptions { voxels, stl, encoding: self.vtk.vtk_encoding, ..self.options })
    }
}

fn is_standard_output(path: &Path) -> bool {
    path.as_os_str() == "-"
}

fn parse_statistics(text: &str) -> Result<PathBuf, String> {
    let path = Path::new(text);
    match TableFormat::of_path(path) {
        Some(_) => Ok(path.to_owned()),
        None => Err("unknown extension; name the file *.json or *.csv".to_owned()),
    }
}

fn parse_series(text: &str) -> Result<PathBuf, String> {
    let path = Path::new(text);
    match path.extension() {
        Some(extension) if extension.eq_ignore_ascii_case("pvd") => Ok(path.to_owned()),
        _ => Err("unknown extension; name the file *.pvd".to_owned()),
    }
}

fn parse_every(text: &str) -> Result<NonZeroU32, String> {
    text.parse().map_err(|_| "give a whole number from 1".to_owned())
}

fn parse_output(text: &str) -> Result<PathBuf, String> {
    let path = Path::new(text);
    if text == "-" || OutputFormat::of_path(path).is_some() {
        return Ok(path.to_owned());
    }
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let hint = nearest_format(&extension).map_or(String::new(), |name| format!(" (did you mean .{name}?)"));
    Err(format!("unknown extension{hint}; name the file {}", OutputFormat::known_extensions()))
}

fn output_help() -> String {
    format!(
        "File to write; its extension names the format: {}; - is standard output; give it again for more files",
        OutputFormat::described()
    )
}

/// The names of formats for grains' own surfaces.
fn grain_formats() -> impl TypedValueParser<Value = OutputFormat> {
    PossibleValuesParser::new(OutputFormat::of_grains().map(OutputFormat::extension))
        .try_map(|name| OutputFormat::of_extension(&name).ok_or("no format has this name"))
}

fn parse_format(text: &str) -> Result<OutputFormat, String> {
    let format = OutputFormat::of_extension(text);
    let hint = || nearest_format(text).map_or(String::new(), |name| format!("did you mean {name}? "));
    format.ok_or_else(|| format!("{}the formats are those of {}", hint(), OutputFormat::known_extensions()))
}

fn nearest_format(text: &str) -> Option<&'static str> {
    nearest(text, OutputFormat::ALL.iter().map(|format| format.extension()))
}
