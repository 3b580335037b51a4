use colorous::{RAINBOW, TABLEAU10, VIRIDIS};

use crate::Polycrystal;

/// What the colours of grains mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Coloring {
    /// Nothing, but that grains of consecutive numbers look different.
    #[default]
    Grain,
    /// The equivalent diameter, from the smallest (violet) to the largest grain (yellow).
    Diameter,
    /// The number of boundaries, from the fewest (violet) to the most (yellow).
    Neighbors,
    /// The phase: blue, orange, red, cyan, green and on, in the order of their numbers.
    Phase,
}

/// Red, green and blue, from 0 to 1.
pub(crate) type Color = [f64; 3];

impl Coloring {
    /// Every way, the default first.
    pub const ALL: [Self; 4] = [Self::Grain, Self::Diameter, Self::Neighbors, Self::Phase];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Grain => "grain",
            Self::Diameter => "diameter",
            Self::Neighbors => "neighbors",
            Self::Phase => "phase",
        }
    }

    /// The colour of each grain.
    pub(crate) fn colors(self, polycrystal: &Polycrystal) -> Vec<Color> {
        let values = match self {
            Self::Grain => {
                // Multiples of the golden ratio stay far from each other round the circle of hues.
                let turn = (5_f64.sqrt() - 1.0) / 2.0;
                let hue = |grain: u32| RAINBOW.eval_continuous((f64::from(grain) * turn).fract());
                return (0..)
                    .take(polycrystal.network.grain_count())
                    .map(|grain| channels(hue(grain)))
                    .collect();
            }
            Self::Phase => {
                // After the last colour the first comes again.
                let color = |phase: usize| channels(TABLEAU10[phase % TABLEAU10.len()]);
                return polycrystal.cells.phase_of().into_iter().map(color).collect();
            }
            Self::Diameter => polycrystal.equivalent_diameters(),
            Self::Neighbors => polycrystal.boundary_counts().into_iter().map(|count| count as f64).collect(),
        };
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let range = values.iter().copied().fold(f64::NEG_INFINITY, f64::max) - least;
        let place = |value: f64| if range > 0.0 { (value - least) / range } else { 0.5 };
        values.into_iter().map(|value| channels(VIRIDIS.eval_continuous(place(value)))).collect()
    }
}

fn channels(color: colorous::Color) -> Color {
    [color.r, color.g, color.b].map(|channel| f64::from(channel) / 255.0)
}
