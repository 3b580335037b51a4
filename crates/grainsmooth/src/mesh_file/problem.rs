use std::io;

use subzero::MeshError;

/// Why a mesh file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum MeshFileProblem {
    /// The file cannot be opened or read.
    #[error("cannot be read: {0}; give the path of a readable mesh file")]
    Unreadable(io::Error),
    /// The extension names no format.
    #[error("unknown extension; give a file *.obj, *.ply, *.stl, *.off, *.vtk, *.vtp, *.vtu or *.json")]
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
    /// The file has no faces.
    #[error("holds no faces; give a surface mesh")]
    NoFaces,
    /// A scheme for triangles was given another polygon.
    #[error(
        "face {face} has {corners} corners where triangles are needed; cut it, or take catmull-clark or doo-sabin"
    )]
    NotATriangle {
        /// The face, counted from 0.
        face: usize,
        /// How many corners it has.
        corners: usize,
    },
    /// A file of control points has both kinds, which only JSON can hold together.
    #[error("holds curves and surfaces, which no mesh format holds together; write .json or give one kind")]
    CurvesAndSurfaces,
    /// The faces make no mesh that the scheme can work with.
    #[error("{0}")]
    Mesh(#[from] MeshError),
}

impl MeshFileProblem {
    /// A line that is wrong; `index` counts from 0.
    pub(super) fn line(index: usize, what: impl Into<String>) -> Self {
        Self::Line { line: index + 1, what: what.into() }
    }

    /// A file that is none of its format, and why; of an error in many lines the first is told.
    pub(super) fn corrupt(format: &'static str, what: impl ToString) -> Self {
        let what = what.to_string();
        Self::Corrupt {
            format,
            what: what.lines().next().unwrap_or_default().trim_end_matches('.').to_owned(),
        }
    }
}
