//! The command lines of `grainsmooth view` and `grainsmooth edit`.

use std::path::PathBuf;

use crate::EditContent;
use clap::Args;

/// View grains in the browser: rotate, explode, slice, hide and isolate them, and colour them by any array
///
/// Serves a page on this machine only, and opens it; Ctrl-C stops it. Several files make a series with a slider.
#[derive(Debug, Args)]
#[command(after_help = VIEW_EXAMPLES)]
pub struct ViewArguments {
    /// Networks of grains: .vtp, .vtu, .vtk or .vtm; or a series, .pvd
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,

    #[command(flatten)]
    pub server: ServerArguments,
}

/// Edit meshes, curves and Bezier patches in the browser: click edges, drag points, step through levels
///
/// Serves a page on this machine only, and opens it; Ctrl-C stops it. Nothing is written unless you save it there.
#[derive(Debug, Args)]
#[command(after_help = EDIT_EXAMPLES)]
pub struct EditArguments {
    /// File to edit: .obj, .ply, .stl, .off, .vtp, .vtu, .vtk, .json, .txt or .bpt
    #[arg(value_name = "FILE", required_unless_present = "teapot")]
    pub file: Option<PathBuf>,

    /// What the file holds, if its extension leaves it open: .txt may hold polylines or control points
    #[arg(long = "as", value_name = "KIND")]
    pub content: Option<EditContent>,

    /// Edit the built-in Utah teapot
    #[arg(long, conflicts_with_all = ["file", "content"])]
    pub teapot: bool,

    #[command(flatten)]
    pub server: ServerArguments,
}

/// Where the page is served.
#[derive(Debug, Args)]
pub struct ServerArguments {
    /// Port on 127.0.0.1 [default: any free port]
    ///
    /// Example: --port 8080, for ssh -L 8080:127.0.0.1:8080 HOST
    #[arg(long, value_name = "P", value_parser = clap::value_parser!(u16).range(1..))]
    pub port: Option<u16>,

    /// Print the link without opening a browser
    #[arg(long)]
    pub no_open: bool,
}

const VIEW_EXAMPLES: &str = "\
Examples:
  grainsmooth view grains.vtp
  grainsmooth view series.pvd                     grains that grow, with a slider over time
  grainsmooth view grains.vtm --no-open           over ssh: open the link here, through ssh -L

Exit status: 0 ended by Ctrl-C, 1 the file is unreadable or no network, 2 a mistake on the command line.";

const EDIT_EXAMPLES: &str = "\
Examples:
  grainsmooth edit cube.obj                       flip, split and collapse edges, drag points, subdivide
  grainsmooth edit outline.obj                    polylines as B-splines, level by level
  grainsmooth edit curve.txt --as bezier          control points, and de Casteljau's construction
  grainsmooth edit --teapot

Exit status: 0 ended by Ctrl-C, 1 the file is unreadable, 2 a mistake on the command line.";
