//! What becomes of short edges of cells, and of their topology.

use polycrystal::{Balance, Reconnections};

use crate::Config;

/// How relaxation changed the topology.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reconnected {
    /// How often grains came together and parted.
    pub reconnections: Reconnections,
    /// How near the network came to equilibrium, where that was asked for.
    pub balance: Option<Balance>,
}

/// What becomes of short edges of the cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Regularization {
    /// Grains come together and part there as tension has it.
    ByEnergy,
    /// What is short, and what relaxation would make so: the best triangles.
    Predicted,
    /// What is short.
    Plain,
    /// What is shorter by some halvings.
    Shorter(u8),
    /// Nothing.
    None,
}

impl Regularization {
    /// A name for programs.
    pub fn name(self) -> &'static str {
        match self {
            Self::ByEnergy => "by_energy",
            Self::Predicted => "full",
            Self::Plain => "short_edges",
            Self::Shorter(_) => "shorter_edges",
            Self::None => "none",
        }
    }

    pub(super) fn in_words(self) -> &'static str {
        match self {
            Self::ByEnergy => "letting grains switch neighbours",
            Self::Predicted => "cells without edges that are or become short",
            Self::Plain => "cells without short edges",
            Self::Shorter(_) => "cells without still shorter edges",
            Self::None => "cells as they are",
        }
    }

    /// Whether less was taken out than is usual where regularisation is asked for.
    pub(crate) fn fell_back(self, config: &Config) -> bool {
        match self {
            Self::ByEnergy | Self::Predicted => false,
            // Where grains are of several cells, those are not what relaxation is predicted for.
            Self::Plain => !config.has_grains_of_several_cells(),
            Self::Shorter(_) => true,
            Self::None => config.effective_regularize() > 0.0,
        }
    }

    /// What to try, one after the other: where much is taken out, in rare places relaxation makes boundaries fold or cross.
    pub(super) fn tries(config: &Config) -> &'static [Self] {
        match config.effective_regularize() {
            _ if config.lets_grains_vanish() => &[Self::ByEnergy],
            _ if config.lets_topology_change() => &[Self::ByEnergy, Self::Predicted, Self::Plain, Self::None],
            0.0 => &[Self::None],
            _ if config.grain_shapes.is_some() => &[Self::Plain],
            _ if config.has_grains_of_several_cells() => &[Self::Plain, Self::Shorter(1), Self::Shorter(2)],
            _ => &[Self::Predicted, Self::Plain, Self::None],
        }
    }
}
