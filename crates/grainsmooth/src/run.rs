//! The stages of a run, one after the other: cells, the network, its relaxation and validation.

pub(crate) mod elements_reached;
pub(crate) mod failing;
pub(crate) mod fitted_cells;
pub(crate) mod given;
pub(crate) mod listed;
pub(crate) mod measured;
pub(crate) mod misorientations;
pub(crate) mod origin;
pub(crate) mod pipeline;
pub(crate) mod polycrystal;
pub(crate) mod regularization;
pub(crate) mod remeshed;
pub(crate) mod stage;
pub(crate) mod tessellated;
pub(crate) mod topology;
