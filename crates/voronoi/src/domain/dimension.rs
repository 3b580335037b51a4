use std::f64::consts::PI;

/// Number of space dimensions of a tessellation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Polygons in the plane z = 0.
    Two,
    /// Polyhedra in space.
    Three,
}

impl Dimension {
    /// The edge of the cube of a volume, in the plane of the square of an area; 0 where rounding made that negative.
    pub fn cube_edge(self, volume: f64) -> f64 {
        match self {
            Self::Two => volume.max(0.0).sqrt(),
            Self::Three => volume.max(0.0).cbrt(),
        }
    }

    /// The diameter of the ball of a volume, in the plane of the disc of an area; 0 where rounding made that negative.
    ///
    /// ```
    /// use voronoi::Dimension;
    ///
    /// let diameter = Dimension::Three.ball_diameter(1.0);
    /// assert!((diameter - 1.2407).abs() < 1e-4, "the equivalent diameter of a unit cube");
    /// assert!((Dimension::Three.ball_volume(diameter) - 1.0).abs() < 1e-12);
    /// ```
    pub fn ball_diameter(self, volume: f64) -> f64 {
        match self {
            Self::Two => 2.0 * (volume.max(0.0) / PI).sqrt(),
            Self::Three => (6.0 * volume.max(0.0) / PI).cbrt(),
        }
    }

    /// The volume of the ball of a diameter, in the plane the area of the disc.
    pub fn ball_volume(self, diameter: f64) -> f64 {
        match self {
            Self::Two => PI / 4.0 * diameter * diameter,
            Self::Three => PI / 6.0 * diameter * diameter * diameter,
        }
    }

    /// The number of axes of coordinates: 2 in the plane, 3 in space.
    pub fn axes(self) -> u8 {
        match self {
            Self::Two => 2,
            Self::Three => 3,
        }
    }

    /// Corners that a face has at least.
    pub(crate) fn fewest_corners(self) -> usize {
        match self {
            Self::Two => 2,
            Self::Three => 3,
        }
    }

    /// Faces that a cell with a volume has at least.
    pub(crate) fn fewest_faces(self) -> usize {
        self.fewest_corners() + 1
    }
}
