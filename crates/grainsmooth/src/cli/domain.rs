//! Options about the domain.

use clap::Args;
use glam::{BVec3, DVec3};
use grainsmooth::FileDomain;
use voronoi::Dimension;

use super::usage;
use super::values::length;

/// What the grains fill.
#[derive(Debug, Args)]
#[command(next_help_heading = "Domain")]
pub struct DomainArguments {
    /// Dimensions: 3 for grains in a box, 2 for grains in a rectangle [default: 3, or those of a .tess file]
    ///
    /// Example: --dim 2
    #[arg(long, value_name = "2|3", value_parser = parse_dimension)]
    dim: Option<Dimension>,

    /// Side lengths of the box in your unit of length, X Y in 2D; a corner is at 0 0 0 [default: 1 1 1, or those of a .tess
    /// file]
    ///
    /// Example: --box 100 100 20
    #[arg(long = "box", value_names = ["X", "Y", "Z"], num_args = 2.., value_parser = parse_side, allow_negative_numbers = true)]
    box_size: Option<Vec<f64>>,

    /// Axes along which the box repeats, such as x,y,z: grains are whole there and grow through the walls [default: none, or
    /// those of a .tess file]
    ///
    /// Example: --periodic x,y
    #[arg(long, value_name = "AXES", value_parser = parse_axes)]
    periodic: Option<BVec3>,
}

impl DomainArguments {
    /// What the grains fill: what is not given is as in the file of the seeds, if that tells.
    pub fn with_defaults_of(&self, file: Option<FileDomain>) -> FileDomain {
        let file = file.unwrap_or(FileDomain {
            dimension: self.dim.unwrap_or(Dimension::Three),
            box_size: DVec3::ONE,
            periodic: BVec3::FALSE,
        });
        let dimension = self.dim.unwrap_or(file.dimension);
        if dimension != file.dimension {
            usage("--dim is not the dimension of the seeds' file; leave it out");
        }
        let periodic = self.periodic.unwrap_or(file.periodic);
        if periodic.z && dimension == Dimension::Two {
            usage("--periodic z needs three dimensions; with --dim 2 give x, y or x,y");
        }
        let box_size = self.box_size.as_deref().map_or(file.box_size, |sides| box_size(sides, dimension));
        FileDomain { dimension, box_size, periodic }
    }
}

/// Side lengths of the box; the last is 1 in 2D.
fn box_size(sides: &[f64], dimension: Dimension) -> DVec3 {
    match (sides, dimension) {
        (&[x, y], Dimension::Two) => DVec3::new(x, y, 1.0),
        (&[x, y, z], Dimension::Three) => DVec3::new(x, y, z),
        (sides, Dimension::Two) => {
            usage(&format!("--box takes two numbers, X Y, with --dim 2; {} given", sides.len()))
        }
        (sides, Dimension::Three) => {
            usage(&format!("--box takes three numbers, X Y Z, without --dim 2; {} given", sides.len()))
        }
    }
}

fn parse_dimension(text: &str) -> Result<Dimension, String> {
    match text {
        "2" => Ok(Dimension::Two),
        "3" => Ok(Dimension::Three),
        _ => Err("grains have 2 or 3 dimensions".to_owned()),
    }
}

fn parse_side(text: &str) -> Result<f64, String> {
    length(text).ok_or_else(|| "a side of the box is a positive number between 1e-30 and 1e30".to_owned())
}

fn parse_axes(text: &str) -> Result<BVec3, String> {
    if text == "none" {
        return Ok(BVec3::FALSE);
    }
    let mut axes = [false; 3];
    let known =
        text.split(',').all(|name| match ["x", "y", "z"].iter().position(|axis| *axis == name.trim()) {
            Some(axis) => !std::mem::replace(&mut axes[axis], true),
            None => false,
        });
    if known {
        Ok(axes.into())
    } else {
        Err("name each axis once, with commas between: x, y, z, x,y or x,y,z; or none".to_owned())
    }
}
