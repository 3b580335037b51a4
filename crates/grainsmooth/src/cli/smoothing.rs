//! Options about the control mesh and volumes.

use crate::spelling::length;
use clap::{Args, ValueEnum};
use polycrystal::{FaceMesh, Volumes};

/// How flat cells become smooth grains.
#[derive(Debug, Args)]
#[command(next_help_heading = "Smoothing")]
pub struct SmoothingArguments {
    /// Triangulate each boundary as a fan around a control point in its middle (fan), or without points inside (plain)
    ///
    /// Example: --faces plain
    #[arg(long, value_name = "RULE", value_enum, default_value_t = FaceRule::Fan)]
    faces: FaceRule,

    /// Refine the control mesh until no edge is longer than H, in the unit of --box; this replaces --faces
    ///
    /// Example: --edge-length 0.05
    #[arg(long, value_name = "H", value_parser = parse_edge_length, allow_negative_numbers = true, conflicts_with = "faces")]
    edge_length: Option<f64>,

    /// Let grains grow and shrink by curvature instead of keeping their volumes (areas in 2D)
    ///
    /// Grains vanish and switch neighbours on the way. With --regularize, in 2D with --edge-length, and in grains of several cells, they cannot; a run that would need it stops with an error.
    ///
    /// Example: --dim 2 --relax 5 --free
    #[arg(long)]
    free: bool,
}

/// `--faces` as it is spelled.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum FaceRule {
    Fan,
    Plain,
}

impl SmoothingArguments {
    /// Control points on boundaries.
    pub(super) fn face_mesh(&self) -> FaceMesh {
        match (self.edge_length, self.faces) {
            (Some(edge_length), _) => FaceMesh::Refined { edge_length },
            (None, FaceRule::Fan) => FaceMesh::Fan,
            (None, FaceRule::Plain) => FaceMesh::Plain,
        }
    }

    /// Whether relaxation keeps volumes.
    pub(super) fn volumes(&self) -> Volumes {
        if self.free { Volumes::Free } else { Volumes::Kept }
    }
}

fn parse_edge_length(text: &str) -> Result<f64, String> {
    length(text).ok_or_else(|| "an edge length is a positive number between 1e-30 and 1e30".to_owned())
}
