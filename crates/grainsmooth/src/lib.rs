//! Virtual polycrystals with smooth, watertight grain boundaries.
