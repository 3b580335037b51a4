//! What makes a surface that of a network: closed, nothing crossed, nothing folded.

pub(crate) mod boundary_survey;
pub(crate) mod box_tree;
pub(crate) mod certificate;
pub(crate) mod closedness;
pub(crate) mod contact;
pub(crate) mod fault;
pub(crate) mod folds;
pub(crate) mod intersections;
pub(crate) mod nesting;
pub(crate) mod normal_cone;
pub(crate) mod orientation;
pub(crate) mod pinched_points;
pub(crate) mod projection;
