//! The rotations that leave a sample as it is.

use std::str::FromStr;

use glam::{DQuat, DVec3};

/// The rotations of the sample under which a texture is the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SampleSymmetry {
    /// None.
    #[default]
    Triclinic,
    /// Half turns around x, y and z, as rolled sheet has: each component comes in four variants.
    Orthorhombic,
}

impl SampleSymmetry {
    /// The rotations, the identity first.
    pub fn rotations(self) -> &'static [DQuat] {
        const ALL: [DQuat; 4] = [
            DQuat::IDENTITY,
            DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0),
            DQuat::from_xyzw(0.0, 1.0, 0.0, 0.0),
            DQuat::from_xyzw(0.0, 0.0, 1.0, 0.0),
        ];
        match self {
            Self::Triclinic => &ALL[..1],
            Self::Orthorhombic => &ALL,
        }
    }

    /// Its name in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Triclinic => "triclinic",
            Self::Orthorhombic => "orthorhombic",
        }
    }

    /// The images of a direction of the sample.
    pub fn images(self, direction: DVec3) -> impl Iterator<Item = DVec3> {
        self.rotations().iter().map(move |rotation| *rotation * direction)
    }
}

impl FromStr for SampleSymmetry {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name.trim().to_lowercase().as_str() {
            "triclinic" | "1" => Ok(Self::Triclinic),
            "orthorhombic" | "orthotropic" | "222" => Ok(Self::Orthorhombic),
            _ => Err(format!("unknown sample symmetry '{name}'; choose triclinic or orthorhombic")),
        }
    }
}
