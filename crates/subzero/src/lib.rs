//! Subdivision of curves, triangle meshes and polygon meshes, with connectivity apart from positions.
