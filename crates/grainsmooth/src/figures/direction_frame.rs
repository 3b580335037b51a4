//! Parts of the sphere of directions in equal-area projection, for figures.

use glam::DVec3;
use texture::{CrystalSymmetry, Projection, Sector};

/// The upper half of directions, or the part of it that stands for all others in a crystal, in a square.
///
/// Places in it go from 0 to 1, to the right and down.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    /// Center of the square and half its width, in units of the projection's radius.
    pub(crate) center: [f64; 2],
    pub(crate) half: f64,
    sector: Option<&'static Sector>,
}

impl Frame {
    /// The frame of the whole upper half.
    pub(crate) const WHOLE: Self = Self { center: [0.0; 2], half: 1.0, sector: None };

    /// The frame around the sector of a symmetry.
    pub(crate) fn of_sector(symmetry: CrystalSymmetry) -> Self {
        let whole = Self { sector: Some(Sector::of(symmetry)), ..Self::WHOLE };
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for direction in whole.border() {
            let point = Projection::EqualArea.project(direction);
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        let half = 0.5 * (high[0] - low[0]).max(high[1] - low[1]);
        Self { center: [0, 1].map(|axis| low[axis].midpoint(high[axis])), half, ..whole }
    }

    /// The direction at a place; nothing where the frame shows none.
    pub(crate) fn direction(&self, [right, down]: [f64; 2]) -> Option<DVec3> {
        let point = [
            self.center[0] + self.half * (2.0 * right - 1.0),
            self.center[1] - self.half * (2.0 * down - 1.0),
        ];
        Projection::EqualArea.direction(point).filter(|direction| self.holds(*direction))
    }

    /// The place of a direction.
    pub(crate) fn place(&self, direction: DVec3) -> [f64; 2] {
        let [x, y] = Projection::EqualArea.project(direction);
        let share = |value: f64, center: f64| 0.5 + 0.5 * (value - center) / self.half;
        [share(x, self.center[0]), 1.0 - share(y, self.center[1])]
    }

    fn holds(&self, direction: DVec3) -> bool {
        let normals = self.sector.map_or(&[][..], Sector::normals);
        normals.iter().all(|normal| normal.dot(direction) >= -1e-9)
    }

    /// Places along the rim, in order.
    pub(crate) fn outline(&self) -> Vec<[f64; 2]> {
        let Some(sector) = self.sector else {
            let rim = |degrees: i32| {
                let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
                self.place(DVec3::new(cosine, sine, 0.0))
            };
            return (0..360).map(rim).collect();
        };
        // Corners stand among them, which degrees seldom meet.
        let center = sector.center();
        let first = sector.marks()[0].reject_from_normalized(center).normalize();
        let second = center.cross(first);
        let angle = |direction: &DVec3| {
            direction.dot(second).atan2(direction.dot(first)).rem_euclid(std::f64::consts::TAU)
        };
        let mut around = self.border();
        around.extend(sector.marks());
        around.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        around.into_iter().map(|direction| self.place(direction)).collect()
    }

    /// Directions on the border of the sector, in order around its middle.
    fn border(&self) -> Vec<DVec3> {
        let Some(sector) = self.sector else { return Vec::new() };
        let center = sector.center();
        let first = sector.marks()[0].reject_from_normalized(center).normalize();
        let second = center.cross(first);
        let out = |degrees: i32| {
            let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
            let tangent = cosine * first + sine * second;
            let at = |arc: f64| arc.cos() * center + arc.sin() * tangent;
            // The farthest that is still inside, by halving.
            let (mut inside, mut outside) = (0.0, std::f64::consts::PI);
            for _ in 0..40 {
                let middle = 0.5 * (inside + outside);
                if self.holds(at(middle)) { inside = middle } else { outside = middle }
            }
            // Halving may end a rounding below the rim, where directions stand for their opposites.
            let end = at(inside);
            end.with_z(end.z.max(0.0))
        };
        (0..360).map(out).collect()
    }
}

/// The corners of a symmetry's sector, red, green and blue in inverse pole figure colours, with their names.
pub(crate) fn named_corners(symmetry: CrystalSymmetry) -> Vec<(&'static str, DVec3)> {
    let names = match symmetry {
        CrystalSymmetry::Octahedral | CrystalSymmetry::Tetrahedral => ["001", "101", "111"],
        CrystalSymmetry::Hexagonal => ["0001", "2-1-10", "10-10"],
        CrystalSymmetry::HexagonalLow => ["0001", "2-1-10", "11-20"],
        CrystalSymmetry::Trigonal => ["0001", "1-100", "10-10"],
        CrystalSymmetry::TrigonalLow => ["0001", "2-1-10", "-12-10"],
        CrystalSymmetry::Tetragonal => ["001", "100", "110"],
        CrystalSymmetry::TetragonalLow | CrystalSymmetry::Orthorhombic => ["001", "100", "010"],
        CrystalSymmetry::Monoclinic => ["001", "100", "-100"],
        CrystalSymmetry::Triclinic => ["", "", ""],
    };
    names.into_iter().zip(Sector::of(symmetry).marks()).collect()
}
