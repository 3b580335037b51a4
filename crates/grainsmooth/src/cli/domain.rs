//! Options about the domain.

use std::path::PathBuf;

use crate::spelling::{self, length};
use crate::{Error, FileDomain, Shape};
use clap::Args;
use glam::{BVec3, DVec3};
use voronoi::Dimension;

use super::usage;

/// The domain that grains fill.
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

    /// Shape of the domain: box, sphere, cylinder (along z), disc (2D), or the file of a closed convex surface, such as .obj or .stl
    ///
    /// A sphere, cylinder or disc touches the sides of --box, which must be equal across its axis, and becomes a polyhedron of
    /// the same volume. A file has its own coordinates, so --box does not apply.
    ///
    /// Example: --domain sphere
    #[arg(long, value_name = "SHAPE", default_value = "box", value_parser = parse_shape)]
    domain: ShapeName,

    /// Define the domain by half-spaces n . x <= d in a text file: nx, ny, nz, d on each line (nx, ny, d in 2D)
    ///
    /// Example: --half-spaces octahedron.csv
    #[arg(long, value_name = "FILE", conflicts_with_all = ["domain", "box_size"])]
    half_spaces: Option<PathBuf>,

    /// How far the flat faces of a sphere, cylinder or disc may be from the true surface, in the unit of --box
    /// [default: 0.005 of its radius]
    ///
    /// Example: --chord-error 0.001
    #[arg(long, value_name = "E", value_parser = parse_chord_error, allow_negative_numbers = true)]
    chord_error: Option<f64>,

    /// Axes along which the box is periodic, such as x,y,z: grains continue across these walls and stay whole [default: none,
    /// or those of a .tess file]
    ///
    /// Example: --periodic x,y
    #[arg(long, value_name = "AXES", value_parser = spelling::axes)]
    periodic: Option<BVec3>,
}

impl DomainArguments {
    /// What the grains fill: what is not given is as in the file of the seeds, if that tells.
    pub(super) fn with_defaults_of(&self, file: Option<FileDomain>) -> Result<FileDomain, Error> {
        let file = file.unwrap_or(FileDomain {
            dimension: self.dim.unwrap_or(Dimension::Three),
            box_size: DVec3::ONE,
            periodic: BVec3::FALSE,
        });
        let dimension = self.dim.unwrap_or(file.dimension);
        if dimension != file.dimension {
            return Err(usage("--dim is not the dimension of the seeds' file; leave it out"));
        }
        let periodic = self.periodic.unwrap_or(file.periodic);
        if periodic.z && dimension == Dimension::Two {
            return Err(usage("--periodic z needs three dimensions; with --dim 2 give x, y or x,y"));
        }
        let box_size =
            self.box_size.as_deref().map_or(Ok(file.box_size), |sides| box_size(sides, dimension))?;
        Ok(FileDomain { dimension, box_size, periodic })
    }

    /// What of the box the grains fill.
    pub(super) fn shape(
        &self,
        &FileDomain { dimension, box_size, periodic }: &FileDomain,
    ) -> Result<Shape, Error> {
        let DVec3 { x, y, z } = box_size;
        let chord_error = self.chord_error.unwrap_or(Shape::CHORD_ERROR * 0.5 * x);
        let shape = match (&self.half_spaces, &self.domain) {
            (Some(path), _) => Shape::HalfSpaces(path.clone()),
            (None, ShapeName::File(path)) => {
                if self.box_size.is_some() {
                    return Err(usage(
                        "--box has no meaning with a --domain from a file, which has its own size",
                    ));
                }
                Shape::Surface(path.clone())
            }
            (None, ShapeName::Box) => Shape::Box,
            (None, ShapeName::Sphere) => {
                if x != y || x != z {
                    return Err(usage(&format!(
                        "--domain sphere needs a --box of equal sides, its diameter; {x} {y} {z} given"
                    )));
                }
                Shape::Sphere { chord_error }
            }
            (None, ShapeName::Cylinder | ShapeName::Disc) => {
                if x != y {
                    let name = if self.domain == ShapeName::Disc { "disc" } else { "cylinder" };
                    return Err(usage(&format!(
                        "--domain {name} needs a --box as wide as deep, its diameter; {x} {y} given"
                    )));
                }
                if self.domain == ShapeName::Disc {
                    Shape::Disc { chord_error }
                } else {
                    Shape::Cylinder { chord_error }
                }
            }
        };
        match (&shape, dimension) {
            (Shape::Sphere { .. } | Shape::Cylinder { .. } | Shape::Surface(_), Dimension::Two) => {
                return Err(usage("with --dim 2 the domain is a box, a disc, or --half-spaces"));
            }
            (Shape::Disc { .. }, Dimension::Three) => {
                return Err(usage("--domain disc is for --dim 2; give sphere or cylinder"));
            }
            _ => {}
        }
        let is_curved = matches!(shape, Shape::Sphere { .. } | Shape::Cylinder { .. } | Shape::Disc { .. });
        if self.chord_error.is_some() && !is_curved {
            return Err(usage(
                "--chord-error is for --domain sphere, cylinder or disc; others have flat faces",
            ));
        }
        if periodic.any() && shape != Shape::Box {
            return Err(usage("--periodic is for boxes; other domains do not repeat"));
        }
        Ok(shape)
    }
}

/// Side lengths of the box; the last is 1 in 2D.
fn box_size(sides: &[f64], dimension: Dimension) -> Result<DVec3, Error> {
    match (sides, dimension) {
        (&[x, y], Dimension::Two) => Ok(DVec3::new(x, y, 1.0)),
        (&[x, y, z], Dimension::Three) => Ok(DVec3::new(x, y, z)),
        (sides, Dimension::Two) => {
            Err(usage(&format!("--box takes two numbers, X Y, with --dim 2; {} given", sides.len())))
        }
        (sides, Dimension::Three) => {
            Err(usage(&format!("--box takes three numbers, X Y Z, without --dim 2; {} given", sides.len())))
        }
    }
}

/// `--domain` as it is spelled.
#[derive(Debug, Clone, PartialEq, Eq)]
enum ShapeName {
    Box,
    Sphere,
    Cylinder,
    Disc,
    File(PathBuf),
}

fn parse_shape(text: &str) -> Result<ShapeName, String> {
    match text {
        "box" => Ok(ShapeName::Box),
        "sphere" => Ok(ShapeName::Sphere),
        "cylinder" => Ok(ShapeName::Cylinder),
        "disc" => Ok(ShapeName::Disc),
        path if path.contains('.') => Ok(ShapeName::File(path.into())),
        _ => Err("give box, sphere, cylinder, disc or a file with an extension, such as body.obj".to_owned()),
    }
}

fn parse_chord_error(text: &str) -> Result<f64, String> {
    length(text).ok_or_else(|| "a chord error is a positive length".to_owned())
}

pub(crate) fn parse_dimension(text: &str) -> Result<Dimension, String> {
    match text {
        "2" => Ok(Dimension::Two),
        "3" => Ok(Dimension::Three),
        _ => Err("grains have 2 or 3 dimensions".to_owned()),
    }
}

fn parse_side(text: &str) -> Result<f64, String> {
    length(text).ok_or_else(|| "a side of the box is a positive number between 1e-30 and 1e30".to_owned())
}
