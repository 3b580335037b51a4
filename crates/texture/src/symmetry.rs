//! The proper rotations that leave a crystal as it is.

use std::fmt;
use std::str::FromStr;

use glam::{DQuat, DVec3};
use thiserror::Error;

/// One of the eleven groups of proper rotations that crystals have.
///
/// The main axis is z (for [`Self::Monoclinic`] y, as usual). In trigonal and hexagonal crystals a two-fold axis lies along x, as TSL has it;
/// HKL's x lies 30 degrees from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum CrystalSymmetry {
    /// 1: triclinic.
    Triclinic,
    /// 2 along y: monoclinic.
    Monoclinic,
    /// 222: orthorhombic.
    Orthorhombic,
    /// 4: tetragonal of the lower Laue group.
    TetragonalLow,
    /// 422: tetragonal.
    Tetragonal,
    /// 3: trigonal of the lower Laue group.
    TrigonalLow,
    /// 32: trigonal, with the two-fold axis along x.
    Trigonal,
    /// 6: hexagonal of the lower Laue group.
    HexagonalLow,
    /// 622: hexagonal.
    Hexagonal,
    /// 23: cubic of the lower Laue group.
    Tetrahedral,
    /// 432: cubic.
    #[default]
    Octahedral,
}

/// A name that is no crystal symmetry.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "unknown crystal symmetry '{name}'; choose a word (cubic, hexagonal, trigonal, tetragonal, orthorhombic, monoclinic, triclinic), \
     a group of rotations ({groups}) or a Laue group ({laue})",
    groups = listed(CrystalSymmetry::rotation_group),
    laue = listed(CrystalSymmetry::laue_group)
)]
pub struct SymmetryError {
    name: String,
}

fn listed(name: fn(CrystalSymmetry) -> &'static str) -> String {
    CrystalSymmetry::ALL.map(name).join(", ")
}

impl CrystalSymmetry {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::Triclinic,
        Self::Monoclinic,
        Self::Orthorhombic,
        Self::TetragonalLow,
        Self::Tetragonal,
        Self::TrigonalLow,
        Self::Trigonal,
        Self::HexagonalLow,
        Self::Hexagonal,
        Self::Tetrahedral,
        Self::Octahedral,
    ];

    /// In words, as a group of rotations and as a Laue group, in the order of [`ALL`](Self::ALL).
    const NAMES: [[&str; 3]; 11] = [
        ["triclinic", "1", "-1"],
        ["monoclinic", "2", "2/m"],
        ["orthorhombic", "222", "mmm"],
        ["4/m", "4", "4/m"],
        ["tetragonal", "422", "4/mmm"],
        ["-3", "3", "-3"],
        ["trigonal", "32", "-3m"],
        ["6/m", "6", "6/m"],
        ["hexagonal", "622", "6/mmm"],
        ["m-3", "23", "m-3"],
        ["cubic", "432", "m-3m"],
    ];

    /// The group of rotations by Hermann and Mauguin, such as 432.
    pub fn rotation_group(self) -> &'static str {
        Self::NAMES[self as usize][1]
    }

    /// The Laue group: these rotations and the inversion, such as m-3m.
    pub fn laue_group(self) -> &'static str {
        Self::NAMES[self as usize][2]
    }

    /// Number of rotations.
    pub fn order(self) -> usize {
        self.rotations().len()
    }

    /// The rotations in crystal coordinates, the identity first.
    pub fn rotations(self) -> &'static [DQuat] {
        use std::sync::OnceLock;
        static GROUPS: OnceLock<[Vec<DQuat>; 11]> = OnceLock::new();
        &GROUPS.get_or_init(|| Self::ALL.map(Self::generated))[self as usize]
    }

    /// The axes of the rotations, each with the least angle around it in radians.
    pub(crate) fn axes(self) -> Vec<(DVec3, f64)> {
        let mut axes: Vec<(DVec3, f64)> = Vec::new();
        for rotation in &self.rotations()[1..] {
            let vector = rotation.xyz();
            let angle = 2.0 * vector.length().atan2(rotation.w.abs());
            let axis = vector.normalize();
            match axes.iter_mut().find(|(other, _)| other.dot(axis).abs() > 1.0 - 1e-9) {
                Some((_, least)) => *least = least.min(angle),
                None => axes.push((axis, angle)),
            }
        }
        axes
    }

    fn generated(self) -> Vec<DQuat> {
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
        let of_generators: &[DQuat] = match self {
            Self::Triclinic => &[],
            Self::Monoclinic => &[turn(y, 2)],
            Self::Orthorhombic => &[turn(z, 2), turn(x, 2)],
            Self::TetragonalLow => &[turn(z, 4)],
            Self::Tetragonal => &[turn(z, 4), turn(x, 2)],
            Self::TrigonalLow => &[turn(z, 3)],
            Self::Trigonal => &[turn(z, 3), turn(x, 2)],
            Self::HexagonalLow => &[turn(z, 6)],
            Self::Hexagonal => &[turn(z, 6), turn(x, 2)],
            Self::Tetrahedral => &[turn(z, 2), turn(DVec3::ONE, 3)],
            Self::Octahedral => &[turn(z, 4), turn(DVec3::ONE, 3)],
        };
        let mut group = vec![DQuat::IDENTITY];
        let mut next = 0;
        while let Some(&rotation) = group.get(next) {
            for generator in of_generators {
                let product = cleaned(rotation * *generator);
                if !group.iter().any(|known| known.dot(product).abs() > 0.999) {
                    group.push(product);
                }
            }
            next += 1;
        }
        group
    }
}

fn turn(axis: DVec3, fold: u32) -> DQuat {
    DQuat::from_axis_angle(axis.normalize(), std::f64::consts::TAU / f64::from(fold))
}

/// The exact value of each part, for products of rotations pile up rounding: in crystals they are 0, 1 and these.
fn cleaned(rotation: DQuat) -> DQuat {
    let exact = [0.0, 0.5, std::f64::consts::FRAC_1_SQRT_2, 0.75_f64.sqrt(), 1.0];
    let parts = rotation.to_array().map(|part| {
        let nearest = exact.into_iter().find(|value| (part.abs() - value).abs() < 1e-6);
        nearest.expect("crystals have no other angles").copysign(part) + 0.0
    });
    DQuat::from_array(parts)
}

impl fmt::Display for CrystalSymmetry {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str(Self::NAMES[*self as usize][0])
    }
}

impl FromStr for CrystalSymmetry {
    type Err = SymmetryError;

    /// By word, group of rotations, or Laue group.
    fn from_str(name: &str) -> Result<Self, SymmetryError> {
        let wanted = name.trim().to_lowercase();
        let found = Self::ALL.into_iter().find(|one| Self::NAMES[*one as usize].contains(&wanted.as_str()));
        found.ok_or_else(|| SymmetryError { name: name.to_owned() })
    }
}
