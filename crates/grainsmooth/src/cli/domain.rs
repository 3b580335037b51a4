//! Options about the domain.

use clap::Args;
use glam::{BVec3, DVec3};
use voronoi::Dimension;

use super::usage;
use super::values::length;

/// What the grains fill.
#[derive(Debug, Args)]
#[command(next_help_heading = "Domain")]
pub struct DomainArguments {
    /// Dimensions: 3 for grains in a box, 2 for grains in a rectangle
    ///
    /// Example: --dim 2
    #[arg(long, value_name = "2|3", default_value = "3", value_parser = parse_dimension)]
    pub dim: Dimension,

    /// Side lengths of the box in your unit of length, X Y in 2D; a corner is at 0 0 0 [default: 1 1 1]
    ///
    /// Example: --box 100 100 20
    #[arg(long = "box", value_names = ["X", "Y", "Z"], num_args = 2.., value_parser = parse_side, allow_negative_numbers = true)]
    box_size: Option<Vec<f64>>,

    /// Axes along which the box repeats, such as x,y,z: grains are whole there and grow through the walls
    ///
    /// Example: --periodic x,y
    #[arg(long, value_name = "AXES", value_parser = parse_axes)]
    periodic: Option<BVec3>,
}

impl DomainArguments {
    /// Side lengths of the box; the last is 1 in 2D.
    pub fn box_size(&self) -> DVec3 {
        match (self.box_size.as_deref(), self.dim) {
            (None, _) => DVec3::ONE,
            (Some(&[x, y]), Dimension::Two) => DVec3::new(x, y, 1.0),
            (Some(&[x, y, z]), Dimension::Three) => DVec3::new(x, y, z),
            (Some(sides), Dimension::Two) => {
                usage(&format!("--box takes two numbers, X Y, with --dim 2; {} given", sides.len()))
            }
            (Some(sides), Dimension::Three) => {
                usage(&format!("--box takes three numbers, X Y Z, without --dim 2; {} given", sides.len()))
            }
        }
    }

    /// Axes along which the box repeats.
    pub fn periodic(&self) -> BVec3 {
        let periodic = self.periodic.unwrap_or(BVec3::FALSE);
        if periodic.z && self.dim == Dimension::Two {
            usage("--periodic z needs three dimensions; with --dim 2 give x, y or x,y");
        }
        periodic
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
    let mut axes = [false; 3];
    let known =
        text.split(',').all(|name| match ["x", "y", "z"].iter().position(|axis| *axis == name.trim()) {
            Some(axis) => !std::mem::replace(&mut axes[axis], true),
            None => false,
        });
    if known {
        Ok(axes.into())
    } else {
        Err("name each axis once, with commas between: x, y, z, x,y or x,y,z".to_owned())
    }
}
