//! The command line of `grainsmooth mesh`.

use std::path::PathBuf;

use crate::Scheme;
use crate::mesh::file::MeshFormat;
use crate::mesh::{EdgeChoice, MeshEdit};
use clap::{Args, Subcommand, ValueEnum};
use subzero::{BoundaryRule, Crease, DooSabinWeights, INFINITE_SHARPNESS, LoopWeights};

use super::files::VtkArguments;
use crate::spelling::{Named, one_of};
use shown::ShownArguments;

mod shown;

/// Subdivide and edit meshes and curves: OBJ, PLY, STL, OFF, VTK or JSON in; VTK, OBJ, PLY, STL or JSON out.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct MeshArguments {
    #[command(subcommand)]
    pub command: MeshCommand,
}

const EXAMPLES: &str = "\
Examples:
  grainsmooth mesh loop cube.obj -n 3 -o smooth.vtp --crease 0-1,1-2:2.5 --corners 7
  grainsmooth mesh catmull-clark cage.ply -n 2 -o out.vtp --each-level    out_0.vtp, out_1.vtp, out_2.vtp
  grainsmooth mesh loop tetrahedron.off --json -o levels.json             all levels, parents and limits
  grainsmooth mesh four-point outline.obj -n 4 --each-level -o curve.pvd --picture curve.png
  grainsmooth mesh collapse part.stl --edge 4-9 -o part.obj
  grainsmooth mesh edit cube.obj triangulate split=flat flip=0-9,3-8 -o presplit.obj

Vertices and faces count from 0, in the order of the file.";

#[derive(Debug, Subcommand)]
pub enum MeshCommand {
    /// Loop's scheme on triangles
    Loop(LoopArguments),
    /// The butterfly scheme on triangles, which keeps the points
    Butterfly(SchemeArguments),
    /// The modified butterfly scheme, smooth at irregular points too
    ModifiedButterfly(SchemeArguments),
    /// Four triangles of one, cut at the midpoints of the edges
    Midpoint(SchemeArguments),
    /// Doo and Sabin's scheme on polygons
    DooSabin(DooSabinArguments),
    /// Catmull and Clark's scheme on polygons, with creases
    CatmullClark(SchemeArguments),
    /// Cubic B-splines of polylines
    BSpline(CurveArguments),
    /// The four-point scheme on polylines, which keeps the points
    FourPoint(CurveArguments),
    /// Points on the limit surface, with its normals there, or on the limit curve
    Limit(LimitArguments),
    /// Normals at the points: means of those of the faces, weighted by area
    Normals(FileArguments),
    /// Make the winding of faces agree: in each part that hangs together, most stay as they are
    Orient(OrientArguments),
    /// Cut polygons into triangles, also polygons that are not convex or in no plane
    Triangulate(FileArguments),
    /// Turn edges within the quadrilaterals of their two triangles
    Flip(EdgeArguments),
    /// Put points on the middles of edges
    Split(EdgeArguments),
    /// Draw the first point of an edge into the second
    Collapse(CollapseArguments),
    /// Several edits, one after the other
    Edit(EditArguments),
    /// Points on Bezier curves and surfaces, given by control points in JSON or plain text
    Bezier(BezierArguments),
}

#[derive(Debug, Args)]
pub struct FileArguments {
    /// File to read; its extension names the format
    #[arg(value_name = "IN")]
    pub input: PathBuf,

    /// File to write; its extension names the format: .vtp, .vtu, .vtk, .obj, .ply, .stl or .json
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,

    /// Write JSON, whatever the extension: levels with their parents, and limits
    #[arg(long)]
    pub json: bool,

    #[command(flatten)]
    pub vtk: VtkArguments,

    #[command(flatten)]
    pub shown: ShownArguments,

    /// Print nothing unless something goes wrong
    #[arg(short, long)]
    pub quiet: bool,
}

#[derive(Debug, Args)]
pub struct FeatureArguments {
    /// Points to fix; with a sharpness, only for that many levels
    #[arg(long, value_name = "V[:SHARPNESS],...", value_delimiter = ',', value_parser = parse_corner)]
    pub corners: Vec<(u32, f32)>,

    /// Edges to keep sharp; with a sharpness, only for that many levels
    #[arg(long = "crease", value_name = "A-B[:SHARPNESS],...", value_delimiter = ',', value_parser = parse_crease)]
    pub creases: Vec<Crease>,

    /// Boundary points of a single face: smoothed along the boundary (edge) or fixed (edge-corner) [default: edge]
    #[arg(long, value_parser = one_of(&BOUNDARIES))]
    pub boundary: Option<BoundaryRule>,
}

#[derive(Debug, Args)]
pub struct SchemeArguments {
    #[command(flatten)]
    pub files: FileArguments,

    #[command(flatten)]
    pub features: FeatureArguments,

    #[command(flatten)]
    pub steps: StepArguments,
}

#[derive(Debug, Args)]
pub struct StepArguments {
    /// Number of subdivisions
    #[arg(short = 'n', long, value_name = "LEVELS", default_value_t = 1, value_parser = clap::value_parser!(u32).range(0..=99))]
    pub levels: u32,

    /// Refuse a mesh with a boundary, or a polyline with ends
    #[arg(long)]
    pub closed: bool,

    /// Write one file per level, OUT_0, OUT_1, ...; for .vtp and .vtu also OUT.pvd, which lists them. OUT may be OUT.pvd itself
    #[arg(long, conflicts_with = "json")]
    pub each_level: bool,
}

#[derive(Debug, Args)]
pub struct CurveArguments {
    #[command(flatten)]
    pub files: FileArguments,

    /// Points to fix, where a curve may have a corner
    #[arg(long, value_name = "V,...", value_delimiter = ',')]
    pub corners: Vec<u32>,

    #[command(flatten)]
    pub steps: StepArguments,
}

#[derive(Debug, Args)]
pub struct LoopArguments {
    #[command(flatten)]
    pub scheme: SchemeArguments,

    /// Weights of the neighbours of a point
    #[arg(long, value_parser = one_of(&WEIGHTS), default_value = "loop")]
    pub weights: LoopWeights,
}

#[derive(Debug, Args)]
pub struct DooSabinArguments {
    #[command(flatten)]
    pub scheme: SchemeArguments,

    /// The weights of Doo and Sabin, or the mean of centroid, corner and midpoints
    #[arg(long, value_parser = one_of(&POLYGON_WEIGHTS), default_value = "doo-sabin")]
    pub weights: DooSabinWeights,
}

#[derive(Debug, Args)]
pub struct LimitArguments {
    #[command(flatten)]
    pub files: FileArguments,

    #[command(flatten)]
    pub features: FeatureArguments,

    /// Number of subdivisions before taking the limit
    #[arg(short = 'n', long, value_name = "LEVELS", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=99))]
    pub levels: u32,

    /// Subdivision scheme
    #[arg(long, value_parser = one_of(&LIMIT_SCHEMES), default_value = "loop")]
    pub scheme: Scheme,

    /// Weights of Loop's scheme
    #[arg(long, value_parser = one_of(&WEIGHTS), default_value = "loop")]
    pub weights: LoopWeights,
}

#[derive(Debug, Args)]
pub struct EdgeArguments {
    #[command(flatten)]
    pub files: FileArguments,

    /// Edges to edit, one after the other: pairs of points; or all, the longest of each triangle, or those between coplanar triangles (flat)
    #[arg(long = "edge", value_name = "A-B|all|longest|flat,...", value_delimiter = ',', required = true, value_parser = parse_choice)]
    pub edges: Vec<EdgeChoice>,
}

#[derive(Debug, Args)]
pub struct CollapseArguments {
    #[command(flatten)]
    pub files: FileArguments,

    /// Edges to collapse, one after the other
    #[arg(long = "edge", value_name = "A-B,...", value_delimiter = ',', required = true, value_parser = parse_edge)]
    pub edges: Vec<[u32; 2]>,
}

#[derive(Debug, Args)]
pub struct EditArguments {
    #[command(flatten)]
    pub files: FileArguments,

    /// Edits in their order: flip=EDGES, split=EDGES, collapse=A-B,..., orient, outward, reverse or triangulate; EDGES are those of
    /// --edge, such as 4-9,7-2 or all, longest, flat
    #[arg(value_name = "EDIT", required = true, value_parser = parse_edit)]
    pub edits: Vec<MeshEdit>,
}

#[derive(Debug, Args)]
pub struct OrientArguments {
    #[command(flatten)]
    pub files: FileArguments,

    /// Reverse closed parts whose normals point inward
    #[arg(long)]
    pub outward: bool,
}

#[derive(Debug, Args)]
pub struct BezierArguments {
    #[command(flatten)]
    pub files: FileArguments,

    /// Number of points on each curve, and along each side of a surface
    #[arg(long, value_name = "N", default_value_t = 33, value_parser = clap::value_parser!(u32).range(2..=10_000))]
    pub samples: u32,

    /// Join all surfaces into one mesh, and fill its holes (closed) or leave them (open)
    #[arg(
        long,
        value_enum,
        value_name = "HOLES",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "closed",
        conflicts_with = "t"
    )]
    pub merge: Option<Merge>,

    /// Write the points of de Casteljau's algorithm for each curve and surface at the parameters --t and --v, level by level
    #[arg(long, requires = "t", conflicts_with = "samples")]
    pub construction: bool,

    /// Parameter on the curves, and along u on the surfaces, from 0 to 1
    #[arg(long, value_name = "T", requires = "construction", value_parser = parse_parameter)]
    pub t: Option<f64>,

    /// Parameter along v on the surfaces [default: that of --t]
    #[arg(long, value_name = "V", requires = "construction", value_parser = parse_parameter)]
    pub v: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Merge {
    /// Holes are filled
    Closed,
    /// Holes stay
    Open,
}

const BOUNDARIES: [Named<BoundaryRule>; 2] =
    [("edge", "", BoundaryRule::Edge), ("edge-corner", "", BoundaryRule::EdgeCorner)];

const WEIGHTS: [Named<LoopWeights>; 3] = [
    ("loop", "Loop 1987", LoopWeights::Loop),
    ("warren", "Warren 1995", LoopWeights::Warren),
    (
        "biermann-levin-zorin",
        "Loop's, and those of Biermann, Levin and Zorin 2000 at creases",
        LoopWeights::BiermannLevinZorin,
    ),
];

const POLYGON_WEIGHTS: [Named<DooSabinWeights>; 2] =
    [("doo-sabin", "", DooSabinWeights::DooSabin), ("means", "", DooSabinWeights::Means)];

/// Loop's scheme is with the weights of another option.
const LIMIT_SCHEMES: [Named<Scheme>; 3] = [
    ("loop", "", Scheme::Loop(LoopWeights::Loop)),
    ("catmull-clark", "", Scheme::CatmullClark),
    ("b-spline", "", Scheme::BSpline),
];

/// What a subcommand asks for, subcommands of a kind together.
pub enum Task<'a> {
    Subdivide(Scheme, &'a StepArguments, Features<'a>),
    Limit(Scheme, &'a LimitArguments),
    Normals,
    Edit(Vec<MeshEdit>),
    Bezier { samples: u32, merge: Option<Merge> },
    Construction { t: f64, v: f64 },
}

/// What a subcommand says about creases and corners.
#[derive(Clone, Copy)]
pub enum Features<'a> {
    OfSurface(&'a FeatureArguments),
    OfCurves { corners: &'a [u32] },
}

impl MeshCommand {
    /// The files, and what to do.
    pub fn task(&self) -> (&FileArguments, Task<'_>) {
        let (scheme, arguments) = match self {
            Self::Loop(arguments) => (Scheme::Loop(arguments.weights), &arguments.scheme),
            Self::Butterfly(arguments) => (Scheme::Butterfly, arguments),
            Self::ModifiedButterfly(arguments) => (Scheme::ModifiedButterfly, arguments),
            Self::Midpoint(arguments) => (Scheme::Midpoint, arguments),
            Self::DooSabin(arguments) => (Scheme::DooSabin(arguments.weights), &arguments.scheme),
            Self::CatmullClark(arguments) => (Scheme::CatmullClark, arguments),
            Self::BSpline(arguments) => return arguments.task(Scheme::BSpline),
            Self::FourPoint(arguments) => return arguments.task(Scheme::FourPoint),
            Self::Limit(arguments) => {
                let scheme = match arguments.scheme {
                    Scheme::Loop(_) => Scheme::Loop(arguments.weights),
                    scheme => scheme,
                };
                return (&arguments.files, Task::Limit(scheme, arguments));
            }
            Self::Normals(files) => return (files, Task::Normals),
            Self::Orient(orient) => {
                let edit = MeshEdit::Orient { outward: orient.outward };
                return (&orient.files, Task::Edit(vec![edit]));
            }
            Self::Triangulate(files) => return (files, Task::Edit(vec![MeshEdit::Triangulate])),
            Self::Flip(edit) => return (&edit.files, Task::Edit(vec![MeshEdit::Flip(edit.edges.clone())])),
            Self::Split(edit) => return (&edit.files, Task::Edit(vec![MeshEdit::Split(edit.edges.clone())])),
            Self::Collapse(edit) => {
                return (&edit.files, Task::Edit(vec![MeshEdit::Collapse(edit.edges.clone())]));
            }
            Self::Edit(edit) => return (&edit.files, Task::Edit(edit.edits.clone())),
            Self::Bezier(bezier) => {
                let task = match bezier.t {
                    Some(t) => Task::Construction { t, v: bezier.v.unwrap_or(t) },
                    None => Task::Bezier { samples: bezier.samples, merge: bezier.merge },
                };
                return (&bezier.files, task);
            }
        };
        let features = Features::OfSurface(&arguments.features);
        (&arguments.files, Task::Subdivide(scheme, &arguments.steps, features))
    }
}

impl CurveArguments {
    fn task(&self, scheme: Scheme) -> (&FileArguments, Task<'_>) {
        let features = Features::OfCurves { corners: &self.corners };
        (&self.files, Task::Subdivide(scheme, &self.steps, features))
    }
}

impl FileArguments {
    /// The format to write, if the extension names one.
    pub fn format(&self) -> Option<MeshFormat> {
        if self.json { Some(MeshFormat::Json) } else { MeshFormat::of_path(&self.output) }
    }

    /// Whether the output is a collection of levels.
    pub fn is_collection(&self) -> bool {
        self.output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("pvd"))
    }
}

fn parse_edge(text: &str) -> Result<[u32; 2], String> {
    let ends = text.split_once('-').and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
    ends.ok_or_else(|| "an edge is two points, such as 4-9".to_owned())
}

fn parse_parameter(text: &str) -> Result<f64, String> {
    let parameter = text.parse().ok().filter(|t| (0.0..=1.0).contains(t));
    parameter.ok_or_else(|| "give a number from 0 (start) to 1 (end)".to_owned())
}

fn parse_choice(text: &str) -> Result<EdgeChoice, String> {
    match text {
        "all" => Ok(EdgeChoice::All),
        "longest" => Ok(EdgeChoice::Longest),
        "flat" => Ok(EdgeChoice::Flat),
        _ => match parse_edge(text) {
            Ok(ends) => Ok(EdgeChoice::Between(ends)),
            Err(_) => Err("edges are two points each, such as 4-9, or all, longest or flat".to_owned()),
        },
    }
}

fn parse_edit(text: &str) -> Result<MeshEdit, String> {
    let (name, edges) = text.split_once('=').unwrap_or((text, ""));
    let choices = || edges.split(',').map(parse_choice).collect::<Result<_, _>>();
    match (name, edges) {
        ("flip", _) => Ok(MeshEdit::Flip(choices()?)),
        ("split", _) => Ok(MeshEdit::Split(choices()?)),
        ("collapse", _) => {
            Ok(MeshEdit::Collapse(edges.split(',').map(parse_edge).collect::<Result<_, _>>()?))
        }
        ("orient", "") => Ok(MeshEdit::Orient { outward: false }),
        ("outward", "") => Ok(MeshEdit::Orient { outward: true }),
        ("reverse", "") => Ok(MeshEdit::Reverse),
        ("triangulate", "") => Ok(MeshEdit::Triangulate),
        _ => Err(
            "an edit is flip=EDGES, split=EDGES, collapse=A-B,..., orient, outward, reverse or triangulate"
                .to_owned(),
        ),
    }
}

/// What stands before the colon, and the sharpness behind it: infinite where there is none.
fn split_sharpness(text: &str) -> (&str, Option<f32>) {
    match text.split_once(':') {
        None => (text, Some(INFINITE_SHARPNESS)),
        Some((feature, sharpness)) => (feature, sharpness.parse().ok().filter(|s: &f32| *s >= 0.0)),
    }
}

fn parse_corner(text: &str) -> Result<(u32, f32), String> {
    let (vertex, sharpness) = split_sharpness(text);
    match (vertex.trim().parse(), sharpness) {
        (Ok(vertex), Some(sharpness)) => Ok((vertex, sharpness)),
        _ => Err("a corner is a point and perhaps a sharpness from 0, such as 3 or 3:1.5".to_owned()),
    }
}

fn parse_crease(text: &str) -> Result<Crease, String> {
    let (ends, sharpness) = split_sharpness(text);
    match (parse_edge(ends), sharpness) {
        (Ok(ends), Some(sharpness)) => Ok(Crease { ends, sharpness }),
        _ => Err("a crease is an edge and perhaps a sharpness from 0, such as 4-9 or 4-9:2.5".to_owned()),
    }
}
