use std::io;

use subzero::{BezierError, MeshError};

use crate::names::LABEL_ARRAYS;

/// Why a mesh file cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshFileProblem {
    /// The file cannot be opened or read.
    #[error("cannot be read: {0}; give the path of a readable mesh file")]
    Unreadable(io::Error),
    /// The extension names no format.
    #[error(
        "unknown extension; give a file *.obj, *.ply, *.stl, *.off, *.vtk, *.vtp, *.vtu, *.json, or polylines as *.txt"
    )]
    UnknownExtension,
    /// A line of a text file is not what it must be.
    #[error("line {line}: {what}")]
    Line {
        /// Line of the file, counted from 1.
        line: usize,
        /// What is wrong with it.
        what: String,
    },
    /// The file ends too early, or is none of its format.
    #[error("{what}; give a complete {format} file")]
    Corrupt {
        /// Name of the format.
        format: &'static str,
        /// What is wrong.
        what: String,
    },
    /// A tessellation in Neper's format is not as it must be.
    #[error("line {line}: {what}")]
    Tess {
        /// The line, counted from 1.
        line: usize,
        /// What is wrong there.
        what: String,
    },
    /// A coordinate's powers leave the range of numbers.
    #[error("point {point} has the coordinate {coordinate:e}; scale the mesh so that none exceeds 1e30")]
    TooFar {
        /// The point, counted from 0.
        point: usize,
        /// The coordinate.
        coordinate: f64,
    },
    /// Powers of the mesh's size leave the range of numbers.
    #[error("the mesh is {width:e} wide; scale it to 1e-30 or more")]
    TooSmall {
        /// The largest side of its bounding box.
        width: f64,
    },
    /// The file has no elements that fill grains.
    #[error(
        "holds no tetrahedra, nor triangles in one plane; give a mesh that fills grains, or a network as .vtp, .vtu or .vtk"
    )]
    NoElements,
    /// The file has no faces.
    #[error("holds no faces; give a surface mesh")]
    NoFaces,
    /// The file has polylines where faces are needed.
    #[error("holds polylines and no faces; give a surface mesh, or use b-spline or four-point")]
    OnlyPolylines,
    /// The file has no polylines.
    #[error(
        "holds no polylines; give lines as .obj, .vtp, .vtu, .vtk, .json or .txt, or use a scheme for surfaces"
    )]
    NoPolylines,
    /// A polyline is a single point.
    #[error("polyline {line} has one point; give at least two")]
    ShortPolyline {
        /// The polyline, counted from 0.
        line: usize,
    },
    /// A corner of a polyline has a sharpness that runs out, for which curves have no rule.
    #[error(
        "corner {vertex} of a polyline has the sharpness {sharpness}; leave it out: corners of polylines are always fixed"
    )]
    SoftCornerOfPolyline {
        /// The point.
        vertex: u32,
        /// Its sharpness.
        sharpness: f32,
    },
    /// A polyline has ends where closed ones are asked for.
    #[error("polyline {line} is open; end it with its first point")]
    OpenPolyline {
        /// The polyline, counted from 0.
        line: usize,
    },
    /// The file does not say what its cells lie between.
    #[error("has no cell array {}; add one with two labels for each triangle", LABEL_ARRAYS.join(" or "))]
    NoLabels,
    /// A file of DREAM.3D has no boundaries.
    #[error(
        "holds no triangle geometry with FaceLabels; make one (Quick Surface Mesh), or smooth its voxels with `grainsmooth smooth`"
    )]
    NoFaceLabels,
    /// A label is beyond all that can number a grain.
    #[error("cell {cell} has the label {label}; number grains from 0 to 4294967295, and the exterior as -1")]
    BadLabel {
        /// The cell, counted from 0.
        cell: usize,
        /// Its label.
        label: i64,
    },
    /// A cell of a network is a polygon with more than three corners.
    #[error("cell {cell} has {corners} corners; cut it into triangles")]
    NotTriangulated {
        /// The cell, counted from 0.
        cell: usize,
        /// How many corners it has.
        corners: usize,
    },
    /// Elements of another kind than triangles, where boundaries are wanted.
    #[error(
        "cell {cell} is a {kind}, not a triangle of a boundary; give the boundaries of the network, such as a .vtp, or of voxels their labels as a .vti to `grainsmooth smooth`"
    )]
    NotABoundary {
        /// The cell, counted from 0.
        cell: usize,
        /// What VTK calls it.
        kind: String,
    },
    /// Elements in a format that is written and not read.
    #[error(
        "elements in .xdmf are only written; to check them, write and give a .vtu, .msh, .inp or .bdf, and for the network a .vtp"
    )]
    ElementsOnlyWritten,
    /// The extension names no format that can hold a network.
    #[error(
        "unknown extension; give a network as *.vtp, *.vtu, *.vtk, *.tess, *.stl, *.fe, *.dmp, *.dream3d, *.json or *.csv"
    )]
    NotANetworkFormat,
    /// An edit that control points have no use for.
    #[error("Bezier curves and patches have only control points; move these")]
    OnlyControlPoints,
    /// A format that is read and not written.
    #[error("this format can only be read; use vtp, vtu, vtk, obj, ply, stl or json")]
    NotWritten,
    /// The extension names no format that can hold measured grains.
    #[error(
        "unknown extension; give a network (*.vtp, *.vtu, *.vtk), a tessellation (*.tess) or a table (*.csv, *.txt, *.json)"
    )]
    NotASampleFormat,
    /// The boundaries of a grain leave gaps.
    #[error("grain {grain} is not closed; repair what `grainsmooth check` finds in the file")]
    NotClosed {
        /// Its number in the file.
        grain: u32,
    },
    /// A grain has no volume.
    #[error("grain {grain} has the volume {volume}; give grains of positive volumes")]
    NoVolume {
        /// Its number in the file.
        grain: u32,
        /// Its volume (in the plane: area).
        volume: f64,
    },
    /// A scheme for triangles was given another polygon.
    #[error(
        "face {face} has {corners} corners where triangles are needed; cut it with `grainsmooth mesh triangulate`, or use catmull-clark or doo-sabin"
    )]
    NotATriangle {
        /// The face, counted from 0.
        face: usize,
        /// How many corners it has.
        corners: usize,
    },
    /// A file of control points has both kinds, which only JSON can hold together.
    #[error("holds both curves and surfaces, which no mesh format can; write .json, or give one kind")]
    CurvesAndSurfaces,
    /// Two faces wind opposite ways.
    #[error("{0}; `grainsmooth mesh orient` makes it agree")]
    Winding(MeshError),
    /// A file of control points has no surfaces where these are to be merged.
    #[error("holds no surfaces to merge; leave --merge out")]
    NoSurfaces,
    /// What is made of the file has no array to colour by.
    #[error(
        "--color-by {name}: the result has no array of this name with one number each; {}",
        known_arrays(known)
    )]
    NoArray {
        /// The name.
        name: String,
        /// The arrays that can be taken.
        known: Vec<String>,
    },
    /// The faces make no mesh that the scheme can work with.
    #[error("{0}")]
    Mesh(MeshError),
    /// The control points make no curve or surface, or more points than ids can count.
    #[error("{0}")]
    Bezier(#[from] BezierError),
}

fn known_arrays(known: &[String]) -> String {
    match known {
        [] => "leave it out".to_owned(),
        _ => format!("give {}, or leave it out", known.join(" or ")),
    }
}

impl From<MeshError> for MeshFileProblem {
    fn from(error: MeshError) -> Self {
        match error {
            MeshError::Winding { .. } => Self::Winding(error),
            _ => Self::Mesh(error),
        }
    }
}

impl MeshFileProblem {
    /// A line that is wrong; `index` counts from 0.
    pub(crate) fn line(index: usize, what: impl Into<String>) -> Self {
        Self::Line { line: index + 1, what: what.into() }
    }

    /// A file that is none of its format, and why; of an error in many lines the first is told.
    pub(crate) fn corrupt(format: &'static str, what: impl ToString) -> Self {
        let what = what.to_string();
        Self::Corrupt {
            format,
            what: what.lines().next().unwrap_or_default().trim_end_matches('.').to_owned(),
        }
    }
}
