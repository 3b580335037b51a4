//! Where cells are: a box that may repeat, or a convex polyhedron.

mod dimension;
pub(crate) mod polyhedron;

use std::fmt;
use std::ops::RangeInclusive;
use std::sync::Arc;

use glam::{BVec3, DVec3};

use crate::domain::polyhedron::Polyhedron;
use crate::exact::big_integer::is_outside;
use crate::exact::frame::Frame;
use crate::exact::half_space::{EVALUATION_ERROR, HalfSpace};
use crate::{Translation, VoronoiError, Wall, WallPlane};

pub use dimension::Dimension;

/// An axis-parallel box, or a rectangle in the plane z = 0, that may repeat periodically along some of its axes; or a convex
/// polyhedron, or polygon in the plane, whose bounding box that box is.
#[derive(Debug, Clone, PartialEq)]
pub struct Domain {
    pub(crate) frame: Frame,
    dimension: Dimension,
    polyhedron: Option<Arc<Polyhedron>>,
}

impl Domain {
    /// Lengths that a domain's sides may have, and half-spaces' distances from the origin up to the largest: products of six lengths, as
    /// shapes of triangles have them, stay numbers with all their digits.
    pub const LENGTHS: RangeInclusive<f64> = 1e-30..=1e30;

    /// A box in space from one corner to the opposite one.
    ///
    /// ```
    /// use glam::DVec3;
    /// use voronoi::Domain;
    ///
    /// let domain = Domain::cuboid(DVec3::ZERO, DVec3::new(2.0, 1.0, 0.5))?;
    /// assert_eq!(domain.measure(), 1.0);
    /// assert_eq!(domain.walls().count(), 6);
    /// # Ok::<(), voronoi::VoronoiError>(())
    /// ```
    ///
    /// # Errors
    /// [`VoronoiError::BadDomain`] when a side is none of [`Self::LENGTHS`].
    pub fn cuboid(lower: DVec3, upper: DVec3) -> Result<Self, VoronoiError> {
        Self::checked(lower, upper, Dimension::Three)
    }

    /// The box with each coordinate multiplied by a factor of its axis.
    ///
    /// # Panics
    /// When the domain is no box, or a factor is not positive and finite.
    #[must_use]
    pub fn stretched(&self, factors: DVec3) -> Self {
        assert!(self.polyhedron.is_none(), "a box");
        assert!(factors.is_finite() && factors.min_element() > 0.0, "positive factors");
        let Frame { lower, upper, .. } = self.frame;
        Self {
            frame: Frame { lower: lower * factors, upper: upper * factors, ..self.frame.clone() },
            ..self.clone()
        }
    }

    /// A rectangle in the plane z = 0; the z coordinates of the corners are ignored.
    ///
    /// ```
    /// use glam::DVec3;
    /// use voronoi::{Domain, Tessellation};
    ///
    /// let domain = Domain::rectangle(DVec3::ZERO, DVec3::new(3.0, 1.0, 0.0))?;
    /// let seeds = [0.5, 1.5, 2.5].map(|x| DVec3::new(x, 0.5, 0.0));
    /// let cells = Tessellation::new(&domain, &seeds)?;
    /// assert!(cells.cell_measures().iter().all(|cell| (cell.volume - 1.0).abs() < 1e-12), "areas, in the plane");
    /// # Ok::<(), voronoi::VoronoiError>(())
    /// ```
    ///
    /// # Errors
    /// [`VoronoiError::BadDomain`] when a side is none of [`Self::LENGTHS`].
    pub fn rectangle(lower: DVec3, upper: DVec3) -> Result<Self, VoronoiError> {
        Self::checked(lower.with_z(0.0), upper.with_z(0.0), Dimension::Two)
    }

    /// The cube [0, 1]^3.
    pub fn unit_cube() -> Self {
        Self::boxed(DVec3::ZERO, DVec3::ONE, Dimension::Three)
    }

    /// The square [0, 1]^2.
    pub fn unit_square() -> Self {
        Self::boxed(DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0), Dimension::Two)
    }

    /// A polyhedron in the box that bounds it.
    pub(crate) fn of_polyhedron(
        lower: DVec3,
        upper: DVec3,
        dimension: Dimension,
        polyhedron: Polyhedron,
    ) -> Self {
        let facets = Some(Arc::clone(&polyhedron.facets));
        let polyhedron = Some(Arc::new(polyhedron));
        Self { frame: Frame::new(lower, upper, dimension.axes().into(), facets), dimension, polyhedron }
    }

    /// A polyhedron with its volume, in the plane area, and a point inside.
    ///
    /// # Panics
    /// For a box.
    #[must_use]
    pub(crate) fn measured(mut self, measure: f64, center: DVec3) -> Self {
        let polyhedron = self.polyhedron.as_mut().expect("a polyhedron");
        let polyhedron = Arc::make_mut(polyhedron);
        (polyhedron.measure, polyhedron.center) = (measure, center);
        self
    }

    fn boxed(lower: DVec3, upper: DVec3, dimension: Dimension) -> Self {
        Self { frame: Frame::new(lower, upper, dimension.axes().into(), None), dimension, polyhedron: None }
    }

    /// The same domain, repeating along the given axes: its two walls there are one, and bound nothing.
    ///
    /// A rectangle cannot repeat along z, which is ignored.
    ///
    /// # Panics
    /// For a polyhedron, if there are axes: only boxes repeat.
    #[must_use]
    pub fn with_periods(self, axes: BVec3) -> Self {
        assert!(self.is_box() || !axes.any(), "only boxes repeat");
        let in_domain = BVec3::new(true, true, self.dimension == Dimension::Three);
        Self { frame: Frame { periodic: axes & in_domain, ..self.frame }, ..self }
    }

    fn checked(lower: DVec3, upper: DVec3, dimension: Dimension) -> Result<Self, VoronoiError> {
        let domain = Self::boxed(lower, upper, dimension);
        let size = domain.size();
        match (0..domain.axes()).find(|axis| size[*axis] <= 0.0) {
            Some(axis) => Err(VoronoiError::BadDomain { axis: AXES[axis], length: size[axis] }),
            None => check_sides(lower, upper, dimension).map(|()| domain),
        }
    }

    /// The corner of the (bounding) box with the smallest coordinates.
    pub fn lower(&self) -> DVec3 {
        self.frame.lower
    }

    /// The corner of the (bounding) box with the largest coordinates.
    pub fn upper(&self) -> DVec3 {
        self.frame.upper
    }

    /// Side lengths of the (bounding) box; z is 0 in the plane.
    pub fn size(&self) -> DVec3 {
        self.frame.size()
    }

    /// A point inside: the middle of a box, the mean of a polyhedron's vertices.
    pub fn center(&self) -> DVec3 {
        let of_box = || self.frame.lower + 0.5 * self.size();
        self.polyhedron.as_ref().map_or_else(of_box, |polyhedron| polyhedron.center)
    }

    /// Two or three dimensions.
    pub fn dimension(&self) -> Dimension {
        self.dimension
    }

    /// Volume; in the plane, area.
    pub fn measure(&self) -> f64 {
        let size = self.size();
        let of_box = || (0..self.axes()).map(|axis| size[axis]).product();
        self.polyhedron.as_ref().map_or_else(of_box, |polyhedron| polyhedron.measure)
    }

    /// The axes along which the domain repeats.
    pub fn periodic(&self) -> BVec3 {
        self.frame.periodic
    }

    /// Whether the domain repeats along some axis.
    pub fn is_periodic(&self) -> bool {
        self.frame.periodic.any()
    }

    /// Whether the domain is its box, and not a polyhedron in it.
    pub fn is_box(&self) -> bool {
        self.polyhedron.is_none()
    }

    /// The walls that bound the domain. Of a box six, or four in the plane, but for those across periodic axes; of a
    /// polyhedron all that it was given.
    pub fn walls(&self) -> impl Iterator<Item = Wall> {
        let periodic = self.frame.periodic;
        let is_box = self.is_box();
        let count = if is_box { 2 * self.axes() } else { self.wall_planes().len() };
        let walls = (0u32..).take(count).map(Wall);
        walls.filter(move |wall| !is_box || !periodic.test(wall.axis()))
    }

    /// The walls of a polyhedron, by number; none for a box.
    pub fn wall_planes(&self) -> &[WallPlane] {
        self.frame.wall_planes()
    }

    /// Unit normal of a wall that points out of the domain.
    pub fn outward_normal(&self, wall: Wall) -> DVec3 {
        self.frame.unit_normals().get(wall.index()).copied().unwrap_or_else(|| wall.outward_normal())
    }

    /// The plane of a wall: its unit outward normal, and the distance from the origin along it; rounded for an oblique wall.
    pub fn wall_equation(&self, wall: Wall) -> (DVec3, f64) {
        let normal = self.outward_normal(wall);
        let distance = match self.across_axis(wall) {
            Some((axis, coordinate)) => normal[axis] * coordinate,
            None => HalfSpace::of_wall(DVec3::ZERO, wall, &self.frame).offset,
        };
        (normal, distance)
    }

    /// The axis that a wall is perpendicular to and the coordinate of the wall there; none for an oblique wall.
    pub fn across_axis(&self, wall: Wall) -> Option<(usize, f64)> {
        match self.wall_planes().get(wall.index()) {
            None => Some((wall.axis(), self.wall_coordinate(wall))),
            Some(plane) => plane.across_axis(),
        }
    }

    /// Coordinate of a wall of a box along its axis.
    ///
    /// # Panics
    /// For a wall of a polyhedron, see [`Self::across_axis`].
    pub fn wall_coordinate(&self, wall: Wall) -> f64 {
        assert!(self.is_box(), "walls of a polyhedron are not perpendicular to axes");
        if wall.is_upper() { self.frame.upper[wall.axis()] } else { self.frame.lower[wall.axis()] }
    }

    /// Visits the walls of a polyhedron that may be up to a distance from a point, or have it beyond them, and some more.
    #[inline]
    pub(crate) fn for_each_wall_within(&self, point: DVec3, distance: f64, visit: impl FnMut(Wall)) {
        if let Some(polyhedron) = &self.polyhedron {
            polyhedron.for_each_wall_within(point, distance, visit);
        }
    }

    /// Visits the walls of a polyhedron that are at most as far away from a point in it as some distance, with theirs.
    #[inline]
    pub(crate) fn for_each_facet_within(&self, point: DVec3, to: f64, mut visit: impl FnMut(HalfSpace, f64)) {
        self.for_each_wall_within(point, to, |wall| {
            let plane = HalfSpace::of_wall(point, wall, &self.frame);
            // Rounding must not make it farther than it is.
            let distance = (plane.offset - EVALUATION_ERROR * plane.offset_size).max(0.0);
            if distance <= to {
                visit(plane, distance);
            }
        });
    }

    /// A point moved by whole periods into the box.
    pub(crate) fn wrapped(&self, point: DVec3) -> DVec3 {
        let period = self.size();
        let below = self.frame.periodic & point.cmplt(self.frame.lower);
        let above = self.frame.periodic & point.cmpge(self.frame.upper);
        point + DVec3::select(below, period, DVec3::ZERO) - DVec3::select(above, period, DVec3::ZERO)
    }

    /// Whether a point lies in the domain or on its walls; exact.
    ///
    /// ```
    /// use glam::DVec3;
    /// use voronoi::Domain;
    ///
    /// assert!(Domain::unit_cube().contains(DVec3::splat(0.5)));
    /// assert!(!Domain::unit_cube().contains(DVec3::splat(1.5)));
    /// ```
    pub fn contains(&self, point: DVec3) -> bool {
        if self.is_box() {
            return point.cmpge(self.frame.lower).all() && point.cmple(self.frame.upper).all();
        }
        let mut is_inside = true;
        self.for_each_wall_within(point, 0.0, |wall| {
            let HalfSpace { offset, offset_size, .. } = HalfSpace::of_wall(point, wall, &self.frame);
            is_inside = is_inside
                && if offset.abs() > EVALUATION_ERROR * offset_size {
                    offset > 0.0
                } else {
                    !is_outside(&self.wall_planes()[wall.index()], point)
                };
        });
        is_inside
    }

    /// Number of axes along which the domain extends.
    pub(crate) fn axes(&self) -> usize {
        usize::from(self.dimension.axes())
    }
}

impl Translation {
    /// The translation as a length.
    pub fn vector(self, domain: &Domain) -> DVec3 {
        self.times(domain.size())
    }
}

const AXES: [char; 3] = ['x', 'y', 'z'];

/// Checks that the sides of a box are lengths; one that is 0 makes it flat, which is another matter.
pub(crate) fn check_sides(lower: DVec3, upper: DVec3, dimension: Dimension) -> Result<(), VoronoiError> {
    let sides = AXES.into_iter().zip((upper - lower).to_array()).take(dimension.axes().into());
    match sides.into_iter().find(|(_, length)| *length != 0.0 && !Domain::LENGTHS.contains(length)) {
        Some((axis, length)) => Err(VoronoiError::BadDomain { axis, length }),
        None => Ok(()),
    }
}

impl fmt::Display for Domain {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(polyhedron) = &self.polyhedron {
            match &polyhedron.name {
                Some(name) => write!(formatter, "{name} in ")?,
                None => write!(formatter, "{} half-spaces in ", self.wall_planes().len())?,
            }
        }
        // The box around a polyhedron is made of corners, which are rounded; its digits tell nothing.
        let shown = |coordinate: f64| {
            let six_digits = || format!("{coordinate:.5e}").parse().unwrap_or(coordinate);
            if self.is_box() { coordinate } else { six_digits() }
        };
        for axis in 0..self.axes() {
            let separator = if axis == 0 { "" } else { " x " };
            write!(
                formatter,
                "{separator}[{}, {}]",
                shown(self.frame.lower[axis]),
                shown(self.frame.upper[axis])
            )?;
        }
        Ok(())
    }
}
