//! Domains that half-spaces have in common.

use std::sync::Arc;

use crate::bodies::extent::Extent;
use crate::domain::check_sides;
use crate::domain::polyhedron::Polyhedron;
use crate::exact::big_integer::unit_normal;
use crate::exact::frame::Facets;
use crate::exact::generator::MOST_WALLS;
use crate::{Dimension, Domain, Tessellation, VoronoiError, WallPlane};

impl Domain {
    /// What half-spaces have in common: a convex polyhedron, whose walls are numbered like the half-spaces.
    ///
    /// Half-spaces that bound nothing do no harm. Decisions are exact here as well: the numbers of a half-space are taken
    /// as they are, and walls that meet in a point do so however many they are.
    ///
    /// ```
    /// use glam::DVec3;
    /// use voronoi::{Domain, WallPlane};
    ///
    /// let signs = [-1.0, 1.0];
    /// let normals = signs.map(|x| signs.map(|y| signs.map(|z| DVec3::new(x, y, z))));
    /// let half_space = |normal| WallPlane::HalfSpace { normal, offset: 1.0 };
    /// let octahedron = Domain::polyhedron(normals.as_flattened().as_flattened().iter().copied().map(half_space).collect())?;
    /// assert!((octahedron.measure() - 4.0 / 3.0).abs() < 1e-14);
    /// assert_eq!(octahedron.lower(), DVec3::NEG_ONE);
    /// # Ok::<(), voronoi::VoronoiError>(())
    /// ```
    ///
    /// # Errors
    /// [`VoronoiError::BadHalfSpace`] names a half-space without a normal, [`VoronoiError::EmptyDomain`] one with nothing in
    /// common with those before it; [`VoronoiError::UnboundedDomain`] a direction without end;
    /// [`VoronoiError::FlatDomain`] when the polyhedron has no volume; [`VoronoiError::FarHalfSpace`] and [`VoronoiError::BadDomain`] for
    /// lengths that are none of [`Self::LENGTHS`]; [`VoronoiError::TooManyWalls`].
    pub fn polyhedron(walls: Vec<WallPlane>) -> Result<Self, VoronoiError> {
        Self::cut_out(walls, Dimension::Three, None)
    }

    /// What half-planes of the plane z = 0 have in common: a convex polygon. Their normals' z must be 0.
    ///
    /// # Errors
    /// As [`Self::polyhedron`].
    pub fn polygon(walls: Vec<WallPlane>) -> Result<Self, VoronoiError> {
        Self::cut_out(walls, Dimension::Two, None)
    }

    /// A polyhedron with a name to print.
    pub(crate) fn cut_out(
        walls: Vec<WallPlane>,
        dimension: Dimension,
        name: Option<String>,
    ) -> Result<Self, VoronoiError> {
        if walls.len() > usize::from(MOST_WALLS) {
            return Err(VoronoiError::TooManyWalls { most: MOST_WALLS });
        }
        let normals = walls.iter().map(unit_normal).collect();
        let facets = Arc::new(Facets { planes: walls, normals });
        let Extent { lower, upper, center } = Extent::of(&facets, dimension)?;
        check_sides(lower, upper, dimension)?;
        let flat = VoronoiError::FlatDomain { lower, upper };
        let polyhedron = Polyhedron::new(facets, lower.abs().max(upper.abs()), name);
        let domain = Self::of_polyhedron(lower, upper, dimension, polyhedron);
        if !domain.contains(center) {
            return Err(flat);
        }
        // The polyhedron is the cell of its only seed.
        let measure = Tessellation::new(&domain, &[center])?.cell_measures()[0].volume;
        if !(measure > 0.0 && measure.is_finite()) {
            return Err(flat);
        }
        Ok(domain.measured(measure, center))
    }
}
