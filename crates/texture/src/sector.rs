//! The part of all directions that stands for all others in a crystal.

use std::sync::OnceLock;

use glam::{DQuat, DVec3};

use crate::CrystalSymmetry;

/// Directions that are equal up to the crystal's Laue group have one representative in its sector, a convex polygon on the sphere.
///
/// Where the border is no mirror, two of its points may be equal: the one with the least y counts.
#[derive(Debug, Clone)]
pub struct Sector {
    rotations: Vec<DQuat>,
    /// Inward normals of the border's great circles.
    normals: Vec<DVec3>,
    /// What is red, green and blue, counter-clockwise seen from outside.
    marks: [DVec3; 3],
    /// What is white.
    center: DVec3,
}

impl Sector {
    /// The sector of a symmetry.
    ///
    /// Around a main axis it lies between azimuths 0 and 360 / order degrees of the upper half, for -3m from -30 to 30; for 2/m y is
    /// not negative; m-3m has z >= x >= y >= 0, m-3 the largest component along z.
    pub fn of(symmetry: CrystalSymmetry) -> &'static Self {
        static SECTORS: OnceLock<[Sector; 11]> = OnceLock::new();
        &SECTORS.get_or_init(|| CrystalSymmetry::ALL.map(Self::new))[symmetry as usize]
    }

    fn new(symmetry: CrystalSymmetry) -> Self {
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        let cube = [z, DVec3::new(1.0, 0.0, 1.0).normalize(), DVec3::ONE.normalize()];
        let (normals, marks) = match symmetry {
            CrystalSymmetry::Triclinic => (vec![z], [equator(0.0), equator(120.0), equator(240.0)]),
            CrystalSymmetry::Monoclinic => (vec![y, z], [z, x, -x]),
            CrystalSymmetry::Orthorhombic | CrystalSymmetry::TetragonalLow => wedge(0.0, 90.0),
            CrystalSymmetry::Tetragonal => wedge(0.0, 45.0),
            CrystalSymmetry::TrigonalLow => wedge(0.0, 120.0),
            CrystalSymmetry::Trigonal => wedge(-30.0, 30.0),
            CrystalSymmetry::HexagonalLow => wedge(0.0, 60.0),
            CrystalSymmetry::Hexagonal => wedge(0.0, 30.0),
            CrystalSymmetry::Tetrahedral => (vec![x, y, z - x, z - y], cube),
            CrystalSymmetry::Octahedral => (vec![y, x - y, z - x], cube),
        };
        let center = match symmetry {
            CrystalSymmetry::Triclinic => z,
            CrystalSymmetry::Monoclinic => (y + z).normalize(),
            CrystalSymmetry::Tetrahedral => {
                (marks.iter().sum::<DVec3>() + DVec3::new(0.0, 1.0, 1.0).normalize()).normalize()
            }
            _ => marks.iter().sum::<DVec3>().normalize(),
        };
        Self { rotations: symmetry.rotations().to_vec(), normals, marks, center }
    }

    /// The representative of a direction; as long as that was.
    pub fn reduce(&self, direction: DVec3) -> DVec3 {
        let tolerance = 1e-12 * direction.length();
        // Rounding may leave a direction on the border outside all images.
        let depth = |image: DVec3| self.normals.iter().map(|normal| normal.dot(image)).fold(0.0, f64::min);
        let is_better = |image: DVec3, than: DVec3| {
            let deeper = depth(image) - depth(than);
            deeper > tolerance || (deeper > -tolerance && image.y < than.y - tolerance)
        };
        let mut best = direction;
        for rotation in &self.rotations {
            let image = *rotation * direction;
            for image in [image, -image] {
                if is_better(image, best) {
                    best = image;
                }
            }
        }
        best
    }

    /// Inward normals of the great circles that bound it.
    pub fn normals(&self) -> &[DVec3] {
        &self.normals
    }

    /// The unit directions that are red, green and blue, counter-clockwise seen from outside: the corners, where there are three.
    pub fn marks(&self) -> [DVec3; 3] {
        self.marks
    }

    /// The unit direction in its middle.
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// The arc in radians from the center to the border along a unit tangent.
    pub(crate) fn arc_to_border(&self, tangent: DVec3) -> f64 {
        let arc = |normal: &DVec3| normal.dot(self.center).atan2(-normal.dot(tangent));
        self.normals.iter().map(arc).fold(f64::INFINITY, f64::min)
    }
}

fn equator(degrees: f64) -> DVec3 {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    DVec3::new(cosine, sine, 0.0)
}

/// The upper half between two azimuths in degrees.
fn wedge(from: f64, to: f64) -> (Vec<DVec3>, [DVec3; 3]) {
    let normals = vec![DVec3::Z, equator(from + 90.0), equator(to - 90.0)];
    (normals, [DVec3::Z, equator(from), equator(to)])
}
