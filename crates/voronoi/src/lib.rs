//! Voronoi cells in two and three dimensions, welded into one cell complex.
