//! Neper's tessellation file, version 3.5, as it is read.
//!
//! <https://neper.info/doc/fileformat.html>. Neper counts from 1; here everything counts from 0.

use glam::DVec3;
use texture::{CrystalSymmetry, Orientation};
use voronoi::{Dimension, Wall};

mod read;

pub use read::{TessProblem, read_tess};

/// Neper's name for a convex polyhedron or polygon.
pub(crate) const POLYHEDRON: &str = "poly";

/// What a .tess file holds of a tessellation with one scale.
#[derive(Debug, Clone, PartialEq)]
pub struct Tess {
    /// Two or three dimensions.
    pub dimension: Dimension,
    /// The number of each cell's seed; none where they are numbered one after the other.
    pub ids: Vec<u32>,
    /// The group of each cell, from 1: this program's phases; none where there are none.
    pub groups: Vec<u32>,
    /// Whether cells have orientations.
    pub has_orientations: bool,
    /// The orientation of each cell; none where there are none, or in a descriptor other than passive Rodrigues vectors, quaternions or
    /// Bunge's Euler angles.
    pub orientations: Vec<Orientation>,
    /// The symmetry of the crystals, where the file tells one that is known.
    pub crystal_symmetry: Option<CrystalSymmetry>,
    /// One seed for each cell; none where the file has none.
    pub seeds: Vec<TessSeed>,
    /// Positions of the vertices; z = 0 in 2D.
    pub vertices: Vec<DVec3>,
    /// The two vertices of each edge.
    pub edges: Vec<[u32; 2]>,
    /// Polygons; in 2D these are the cells.
    pub faces: Vec<TessFace>,
    /// The faces of each cell, not reversed where their normal points outward; empty in 2D.
    pub polyhedra: Vec<Vec<Oriented>>,
    /// What the cells fill.
    pub domain: TessDomain,
    /// What has a periodic image; nothing unless the tessellation is periodic.
    pub periodicity: Option<TessPeriodicity>,
}

/// A seed as Neper has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TessSeed {
    /// Coordinates.
    pub position: DVec3,
    /// Neper's weight: the radius of the seed's sphere, 0 in a Voronoi tessellation.
    pub radius: f64,
}

/// A polygon.
#[derive(Debug, Clone, PartialEq)]
pub struct TessFace {
    /// Its corners in order.
    pub vertices: Vec<u32>,
    /// Its edges, the first from the first corner to the second.
    pub edges: Vec<Oriented>,
    /// The plane a x + b y + c z = d as [d, a, b, c], with a unit normal.
    pub plane: [f64; 4],
}

/// An edge of a face or a face of a cell, with its sense.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Oriented {
    /// Which.
    pub index: u32,
    /// Whether it runs, or its normal points, the other way.
    pub is_reversed: bool,
}

/// What the cells fill.
#[derive(Debug, Clone, PartialEq)]
pub struct TessDomain {
    /// Neper's name for it; `cube` is any box, `square` any rectangle (`cube` there too in files of Neper, read as `square`), `poly` any convex polyhedron or polygon.
    pub kind: String,
    /// The corner of its bounding box with the smallest coordinates.
    pub lower: DVec3,
    /// The corner of its bounding box with the largest coordinates.
    pub upper: DVec3,
    /// For each wall the faces on it; in 2D, the edges. Those of a box are in the order of [`Wall::ALL`]; empty for a domain of
    /// yet another kind.
    pub walls: Vec<Vec<u32>>,
}

/// Vertices, edges and faces that are others moved by whole periods.
#[derive(Debug, Clone, PartialEq)]
pub struct TessPeriodicity {
    /// Whether each axis is periodic.
    pub axes: [bool; 3],
    /// Side lengths of the domain.
    pub lengths: DVec3,
    /// Images of seeds: the cell, and by how many periods it is moved.
    pub seeds: Vec<(u32, [i32; 3])>,
    /// Vertices.
    pub vertices: Vec<TessCopy>,
    /// Edges.
    pub edges: Vec<TessCopy>,
    /// Faces; empty in 2D.
    pub faces: Vec<TessCopy>,
}

/// `secondary = primary + translation`, in periods.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TessCopy {
    /// The moved one.
    pub secondary: u32,
    /// The other one, and whether the two run, or their normals point, opposite ways.
    pub primary: Oriented,
    /// Periods along x, y and z.
    pub translation: [i32; 3],
}

impl Tess {
    /// The faces (in the plane: edges) of all cells, each with its cell: not reversed where the cell is on the first side.
    pub(crate) fn sides_of_cells(&self) -> impl Iterator<Item = (u32, Oriented)> {
        let of_cells: Vec<&[Oriented]> = match self.dimension {
            Dimension::Two => self.faces.iter().map(|face| &face.edges[..]).collect(),
            Dimension::Three => self.polyhedra.iter().map(|faces| &faces[..]).collect(),
        };
        (0..).zip(of_cells).flat_map(|(cell, sides)| sides.iter().map(move |side| (cell, *side)))
    }

    /// The volume of each cell (in the plane: area) as its faces bound it.
    pub fn cell_volumes(&self) -> Vec<f64> {
        let corner = |face: &TessFace, index: usize| self.vertices[face.vertices[index] as usize];
        match self.dimension {
            Dimension::Two => {
                let area = |face: &TessFace| {
                    // About a corner, so that no digits cancel far from the origin.
                    let at = |index| corner(face, index) - corner(face, 0);
                    (2..face.vertices.len())
                        .map(|last| at(last - 1).cross(at(last)).z / 2.0)
                        .sum::<f64>()
                        .abs()
                };
                self.faces.iter().map(area).collect()
            }
            Dimension::Three => {
                let cone = |part: &Oriented, apex: DVec3| {
                    let face = &self.faces[part.index as usize];
                    let at = |index| corner(face, index) - apex;
                    let triangles = 2..face.vertices.len();
                    let volume: f64 =
                        triangles.map(|last| at(0).dot(at(last - 1).cross(at(last))) / 6.0).sum();
                    if part.is_reversed { -volume } else { volume }
                };
                let volume = |parts: &Vec<Oriented>| {
                    let faces = parts.iter().map(|part| &self.faces[part.index as usize]);
                    let apex = faces.flat_map(|face| face.vertices.first()).next();
                    let apex = apex.map_or(DVec3::ZERO, |&vertex| self.vertices[vertex as usize]);
                    parts.iter().map(|part| cone(part, apex)).sum()
                };
                self.polyhedra.iter().map(volume).collect()
            }
        }
    }
}

impl TessDomain {
    /// Neper's name of a wall: `x0` to `z1` of a box, else `f1`, `f2`, and so on.
    pub(crate) fn label(&self, wall: Wall) -> String {
        if self.kind == POLYHEDRON {
            format!("f{}", wall.index() + 1)
        } else {
            format!("{}{}", ['x', 'y', 'z'][wall.axis()], u8::from(wall.is_upper()))
        }
    }
}
