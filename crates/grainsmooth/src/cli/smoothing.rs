//! Options about the control mesh, relaxation and subdivision.

use clap::{Args, ValueEnum};
use grainsmooth::{Config, LawOptions};
use polycrystal::{FaceMesh, Junctions, Relaxation, Volumes};

use super::values::{length, whole_number};

/// How flat cells become smooth grains.
#[derive(Debug, Args)]
#[command(next_help_heading = "Smoothing")]
pub struct SmoothingArguments {
    /// Control points inside boundaries: a fan of triangles round one in the middle (fan), or none (plain)
    ///
    /// Example: --faces plain
    #[arg(long, value_name = "RULE", value_enum, default_value_t = FaceRule::Fan)]
    faces: FaceRule,

    /// Refine the control mesh instead until no edge is longer than H, in the unit of --box; a grain is about as wide as the
    /// cube root of its volume
    ///
    /// Example: --edge-length 0.05
    #[arg(long, value_name = "H", value_parser = parse_edge_length, allow_negative_numbers = true, conflicts_with = "faces")]
    edge_length: Option<f64>,

    /// Relaxation time, in units of the mean grain size squared, or `equilibrium`; 0 keeps boundaries flat [default: 1.2, in
    /// 2D equilibrium; 0 with lamellae, 0.05 with --grain-shapes, 0.3 with --free and --regularize, in 2D with --edge-length too]
    ///
    /// Example: --relax 0.1
    #[arg(long, value_name = "T", value_parser = parse_relaxation, allow_negative_numbers = true)]
    pub relax: Option<Relaxation>,

    /// Tension of the walls, in units of that between grains, of the largest with --tension; 0 lets boundaries meet walls at right angles
    ///
    /// Example: --wall-tension 0.5
    #[arg(long, value_name = "G", default_value_t = 0.0, value_parser = parse_tension, allow_negative_numbers = true)]
    pub wall_tension: f64,

    /// Tension of boundaries between grains, in any unit: a number, read-shockley(15) over the disorientation, that times a number, or a
    /// table of angles and tensions; with PHASE/PHASE: before it, of boundaries between these [default: 1]
    ///
    /// Example: --texture 'goss(10)' --tension 'read-shockley(15)'
    #[arg(long, value_name = "[A/B:]LAW", num_args = 1)]
    pub tension: Vec<LawOptions>,

    /// Mobility of boundaries between grains that grow, in any unit: a law as of --tension, such as humphreys(15) [default: 1]
    ///
    /// Example: --relax 0.02 --free --texture 'goss(10)' --mobility 'humphreys(15)'
    #[arg(long, value_name = "[A/B:]LAW", num_args = 1)]
    pub mobility: Vec<LawOptions>,

    /// Let grains grow and shrink by curvature instead of keeping their volumes (in 2D: areas); none may vanish
    ///
    /// Example: --relax 0.02 --free
    #[arg(long)]
    free: bool,

    /// Keep the neighbours of the cells instead of letting grains switch them, but for edges shorter than L mean grain sizes, which
    /// become points; 0 keeps all
    ///
    /// Example: --regularize 0.05
    #[arg(long, value_name = "L", value_parser = parse_regularize, allow_negative_numbers = true)]
    pub regularize: Option<f64>,

    /// Number of subdivisions; each makes four triangles of one (two segments in 2D)
    ///
    /// Example: -n 2
    #[arg(short = 'n', long, value_name = "LEVELS", default_value_t = Config::default().levels, value_parser = whole_number(0..=99_u32), allow_negative_numbers = true)]
    pub levels: u32,

    /// Triple lines as smooth curves (crease) or as polylines through all their control points (corner)
    ///
    /// Example: --junctions corner
    #[arg(long, value_name = "RULE", value_enum, default_value_t = JunctionRule::Crease)]
    junctions: JunctionRule,
}

/// `--faces` as it is spelled.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum FaceRule {
    Fan,
    Plain,
}

/// `--junctions` as it is spelled.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum JunctionRule {
    Crease,
    Corner,
}

impl SmoothingArguments {
    /// Control points on boundaries.
    pub fn face_mesh(&self) -> FaceMesh {
        match (self.edge_length, self.faces) {
            (Some(edge_length), _) => FaceMesh::Refined { edge_length },
            (None, FaceRule::Fan) => FaceMesh::Fan,
            (None, FaceRule::Plain) => FaceMesh::Plain,
        }
    }

    /// How triple lines are smoothed.
    pub fn junctions(&self) -> Junctions {
        match self.junctions {
            JunctionRule::Crease => Junctions::Crease,
            JunctionRule::Corner => Junctions::Corner,
        }
    }

    /// Whether relaxation keeps volumes.
    pub fn volumes(&self) -> Volumes {
        if self.free { Volumes::Free } else { Volumes::Kept }
    }
}

fn parse_edge_length(text: &str) -> Result<f64, String> {
    length(text).ok_or_else(|| "an edge length is a positive number between 1e-30 and 1e30".to_owned())
}

fn parse_relaxation(text: &str) -> Result<Relaxation, String> {
    if text == "equilibrium" {
        return Ok(Relaxation::Equilibrium);
    }
    let time = text.parse().ok().filter(|time: &f64| time.is_finite() && *time >= 0.0);
    let time = time.ok_or_else(|| {
        "the relaxation time is 0 (off), a positive, finite number, or equilibrium".to_owned()
    });
    time.map(Relaxation::Time)
}

fn parse_tension(text: &str) -> Result<f64, String> {
    let tension = text.parse().ok().filter(|tension: &f64| tension.is_finite() && *tension >= 0.0);
    tension.ok_or_else(|| "a tension is 0 or a positive, finite number".to_owned())
}

fn parse_regularize(text: &str) -> Result<f64, String> {
    let length = text.parse().ok().filter(|length| (0.0..=Config::LARGEST_REGULARIZE).contains(length));
    length.ok_or_else(|| format!("give a length from 0 (off) to {}", Config::LARGEST_REGULARIZE))
}
