//! How points of an orientation map become grains.

use std::fmt;
use std::str::FromStr;

use clap::Args;
use glam::DVec3;
use texture::CrystalSymmetry;

use crate::spelling::whole_number;

/// Degrees above which neighbouring points belong to different grains: what most of this trade use between low and high angle boundaries is 5 to 15.
const THRESHOLD: f64 = 5.0;

/// Degrees by which a boundary may differ from a twin's, as in DREAM.3D.
const TWIN_TOLERANCE: f64 = 3.0;

/// How grains are found in a map of orientations.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Map of orientations")]
pub struct EbsdOptions {
    /// Largest angle in degrees between neighbouring points of one grain [default: 5]
    ///
    /// Example: grainsmooth smooth map.ctf --threshold 10
    #[arg(long, value_name = "DEGREES", value_parser = angle, allow_negative_numbers = true)]
    pub threshold: Option<f64>,

    /// Least confidence index of a point; points below it are filled from their neighbours
    ///
    /// Example: grainsmooth smooth map.ang --min-ci 0.1
    #[arg(long, value_name = "CI", value_parser = finite, allow_negative_numbers = true)]
    pub min_ci: Option<f64>,

    /// Least image quality of a point, or band contrast in .ctf; points below it are filled from their neighbours
    ///
    /// Example: grainsmooth smooth map.ang --min-iq 120
    #[arg(long, value_name = "IQ", value_parser = finite, allow_negative_numbers = true)]
    pub min_iq: Option<f64>,

    /// Least number of connected points without a good solution that form a pore; fewer are filled from their neighbours [default: all are filled]
    ///
    /// Example: grainsmooth smooth map.ang --min-pore 200
    #[arg(long, value_name = "N", value_parser = whole_number(1..=u64::MAX), allow_negative_numbers = true)]
    pub min_pore: Option<u64>,

    /// Merge twins into one grain: those rotated by this angle about this axis of the crystal
    ///
    /// The axis has components along the orthogonal axes of the crystal; in hexagonal ones x is along a and z along c. A grain of several twins has the orientation and the
    /// spread of its largest part.
    ///
    /// Example: grainsmooth smooth nickel.ang --merge-twins 60,1,1,1
    #[arg(long, value_name = "DEGREES,X,Y,Z", allow_hyphen_values = true)]
    pub merge_twins: Option<AxisAngle>,

    /// Tolerance of --merge-twins in degrees [default: 3]
    ///
    /// Example: grainsmooth smooth nickel.ang --merge-twins 60,1,1,1 --twin-tolerance 5
    #[arg(long, value_name = "DEGREES", value_parser = angle, allow_negative_numbers = true, requires = "merge_twins")]
    pub twin_tolerance: Option<f64>,

    /// Rotate all crystals by an angle about an axis of the sample; points stay where they are
    ///
    /// Example: grainsmooth smooth map.ang --rotate 180,1,0,0
    #[arg(long, value_name = "DEGREES,X,Y,Z", allow_hyphen_values = true)]
    pub rotate: Option<AxisAngle>,

    /// Shift the sections of a stack so that crystals agree best with those of the section before
    ///
    /// Sections move by whole points; what is not in all of them afterwards is left out.
    ///
    /// Example: grainsmooth smooth sections --align --spacing 0.25 0.25 0.3
    #[arg(long)]
    pub align: bool,

    /// Symmetry of the crystals, if the file gives none
    ///
    /// Example: grainsmooth smooth map.ang --crystal-symmetry cubic
    #[arg(long, value_name = "SYMMETRY")]
    pub crystal_symmetry: Option<CrystalSymmetry>,
}

impl EbsdOptions {
    pub(super) fn threshold(&self) -> f64 {
        self.threshold.unwrap_or(THRESHOLD)
    }

    pub(super) fn twin_tolerance(&self) -> f64 {
        self.twin_tolerance.unwrap_or(TWIN_TOLERANCE)
    }

    /// The first of these options that is given.
    pub(crate) fn first_given(&self) -> Option<&'static str> {
        let all = [
            ("--threshold", self.threshold.is_some()),
            ("--min-ci", self.min_ci.is_some()),
            ("--min-iq", self.min_iq.is_some()),
            ("--min-pore", self.min_pore.is_some()),
            ("--merge-twins", self.merge_twins.is_some()),
            ("--rotate", self.rotate.is_some()),
            ("--align", self.align),
            ("--crystal-symmetry", self.crystal_symmetry.is_some()),
        ];
        all.into_iter().find(|(_, is_given)| *is_given).map(|(name, _)| name)
    }
}

/// A rotation by an angle about an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisAngle {
    /// In degrees.
    pub angle: f64,
    /// Of any length above 0.
    pub axis: DVec3,
}

impl FromStr for AxisAngle {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Option<Vec<f64>> = text.split(',').map(|number| finite(number).ok()).collect();
        let found = match numbers.as_deref() {
            Some(&[angle, x, y, z]) => Some(Self { angle, axis: DVec3::new(x, y, z) }),
            _ => None,
        };
        found
            .filter(|found| found.axis != DVec3::ZERO)
            .ok_or_else(|| "give an angle in degrees and an axis, as in 60,1,1,1".to_owned())
    }
}

impl fmt::Display for AxisAngle {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { angle, axis: DVec3 { x, y, z } } = self;
        write!(out, "{angle},{x},{y},{z}")
    }
}

fn finite(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| "give a finite number".to_owned())
}

fn angle(text: &str) -> Result<f64, String> {
    let angle = finite(text).ok().filter(|angle| (0.0..=180.0).contains(angle));
    angle.ok_or_else(|| "give an angle from 0 to 180 degrees".to_owned())
}
