//! The grain-boundary network of a polycrystal: junctions, relaxation, subdivision, measures, validation.
