//! Lattices of seeds, by name.

use voronoi::Dimension;

/// How seeds are arranged, by the names of crystallography.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lattice {
    /// Simple cubic: cubes.
    SimpleCubic,
    /// Body-centred cubic: truncated octahedra, Kelvin's foam.
    BodyCentredCubic,
    /// Face-centred cubic: rhombic dodecahedra.
    FaceCentredCubic,
    /// Hexagonal close-packed: trapezo-rhombic dodecahedra. The cell is a : √3 a : √(8/3) a.
    HexagonalClosePacked,
    /// Squares, in the plane.
    Square,
    /// Hexagons, in the plane. The cell is a : √3 a.
    Hexagonal,
}

impl Lattice {
    /// All lattices with their names on the command line.
    pub const ALL: [(Self, &'static str); 6] = [
        (Self::SimpleCubic, "sc"),
        (Self::BodyCentredCubic, "bcc"),
        (Self::FaceCentredCubic, "fcc"),
        (Self::HexagonalClosePacked, "hcp"),
        (Self::Square, "square"),
        (Self::Hexagonal, "hex"),
    ];

    /// The dimension that the lattice belongs to.
    pub fn dimension(self) -> Dimension {
        match self {
            Self::Square | Self::Hexagonal => Dimension::Two,
            _ => Dimension::Three,
        }
    }

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        Self::ALL.into_iter().find(|(one, _)| *one == self).map_or("", |(_, name)| name)
    }
}
