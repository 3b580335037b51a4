//! A distribution of orientations.

use crate::{Component, CrystalSymmetry, Kernel, Orientation, SampleSymmetry};

/// A distribution of orientations by volume: a sum of [`Component`]s.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    parts: Vec<Part>,
    sample_symmetry: SampleSymmetry,
}

/// A component with its share of the volume.
#[derive(Debug, Clone, PartialEq)]
struct Part {
    component: Component,
    share: f64,
    name: String,
}

impl Texture {
    /// Any orientation is as likely as any other.
    pub fn random() -> Self {
        Self::sum([(Component::Random, 1.0, "random".to_owned())])
    }

    /// Components with weights and names. Weights are positive; they are divided by their sum.
    ///
    /// # Panics
    /// Without a component.
    pub(crate) fn sum(parts: impl IntoIterator<Item = (Component, f64, String)>) -> Self {
        let mut parts: Vec<Part> =
            parts.into_iter().map(|(component, share, name)| Part { component, share, name }).collect();
        assert!(!parts.is_empty(), "a texture has a component");
        let sum: f64 = parts.iter().map(|part| part.share).sum();
        parts.iter_mut().for_each(|part| part.share /= sum);
        Self { parts, sample_symmetry: SampleSymmetry::Triclinic }
    }

    /// Some orientations with weights, each spread by a kernel if one is given.
    ///
    /// Nothing without a positive weight, or with one that is negative or not finite.
    ///
    /// ```
    /// use texture::{Kernel, Orientation, Texture};
    ///
    /// let measured = [([0.0, 45.0, 0.0], 3.0), ([35.0, 45.0, 0.0], 1.0)].map(|(angles, weight)| (Orientation::from_euler_degrees(angles), weight));
    /// let texture = Texture::of_list(&measured, Some(Kernel::new(5.0)?), "measured").expect("weights above 0");
    /// assert!(texture.is_spread());
    /// # Ok::<(), texture::HalfwidthError>(())
    /// ```
    pub fn of_list(weighted: &[(Orientation, f64)], kernel: Option<Kernel>, name: &str) -> Option<Self> {
        let sum: f64 = weighted.iter().map(|(_, weight)| *weight).sum();
        if weighted.iter().any(|(_, weight)| *weight < 0.0) || !(sum > 0.0 && sum.is_finite()) {
            return None;
        }
        let mut before = 0.0;
        let with_sums = weighted.iter().map(|(orientation, weight)| {
            before += weight / sum;
            (*orientation, before)
        });
        let component = Component::List { orientations: with_sums.collect(), kernel };
        Some(Self::sum([(component, 1.0, name.to_owned())]))
    }

    /// The same, and equal under a symmetry of the sample: each component comes in all its variants.
    #[must_use]
    pub fn with_sample_symmetry(self, sample_symmetry: SampleSymmetry) -> Self {
        Self { sample_symmetry, ..self }
    }

    /// The symmetry of the sample.
    pub fn sample_symmetry(&self) -> SampleSymmetry {
        self.sample_symmetry
    }

    /// The components with their shares of the volume, which add up to 1, and their names.
    pub fn components(&self) -> impl ExactSizeIterator<Item = (&Component, f64, &str)> {
        self.parts.iter().map(|part| (&part.component, part.share, part.name.as_str()))
    }

    /// Density at an orientation in multiples of random. What has no spread counts as nothing.
    ///
    /// ```
    /// use texture::{CrystalSymmetry, Orientation, Texture};
    ///
    /// let cube = Orientation::from_euler_degrees([0.0; 3]);
    /// assert_eq!(Texture::random().density(cube, CrystalSymmetry::Octahedral), 1.0);
    /// let texture: Texture = "cube(10)".parse()?;
    /// assert!(texture.density(cube, CrystalSymmetry::Octahedral) > 10.0, "times random");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn density(&self, orientation: Orientation, symmetry: CrystalSymmetry) -> f64 {
        let rotations = self.sample_symmetry.rotations();
        let count = rotations.len() as f64;
        let mut density = 0.0;
        for rotation in rotations {
            let image = Orientation::new(*rotation * orientation.raw());
            let of_part = |part: &Part| part.share * part.component.density(image, symmetry);
            density += self.parts.iter().map(of_part).sum::<f64>() / count;
        }
        density
    }

    /// Whether all of it has a density.
    pub fn is_spread(&self) -> bool {
        self.parts.iter().all(|part| part.component.is_spread())
    }
}
