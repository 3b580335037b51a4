use std::f64::consts::PI;
use std::fmt;
use std::ops::RangeInclusive;
use std::sync::Arc;

use glam::{BVec3, DVec3};

use crate::big::{is_outside, unit_normal};
use crate::half_space::{EVALUATION_ERROR, HalfSpace};
use crate::polyhedron::{Extent, Polyhedron};
use crate::{Tessellation, VoronoiError, Wall, WallPlane};

/// Number of space dimensions of a tessellation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Polygons in the plane z = 0.
    Two,
    /// Polyhedra in space.
    Three,
}

impl Dimension {
    /// The edge of the cube of a volume, in the plane of the square of an area; 0 where rounding made that negative.
    pub fn cube_edge(self, volume: f64) -> f64 {
        match self {
            Self::Two => volume.max(0.0).sqrt(),
            Self::Three => volume.max(0.0).cbrt(),
        }
    }

    /// The diameter of the ball of a volume, in the plane of the disc of an area; 0 where rounding made that negative.
    pub fn ball_diameter(self, volume: f64) -> f64 {
        match self {
            Self::Two => 2.0 * (volume.max(0.0) / PI).sqrt(),
            Self::Three => (6.0 * volume.max(0.0) / PI).cbrt(),
        }
    }

    /// The volume of the ball of a diameter, in the plane the area of the disc.
    pub fn ball_volume(self, diameter: f64) -> f64 {
        match self {
            Self::Two => PI / 4.0 * diameter * diameter,
            Self::Three => PI / 6.0 * diameter * diameter * diameter,
        }
    }

    /// The number of axes of coordinates: 2 in the plane, 3 in space.
    pub fn axes(self) -> u8 {
        match self {
            Self::Two => 2,
            Self::Three => 3,
        }
    }

    /// Corners that a face has at least.
    pub(crate) fn fewest_corners(self) -> usize {
        match self {
            Self::Two => 2,
            Self::Three => 3,
        }
    }

    /// Faces that a cell with a volume has at least.
    pub(crate) fn fewest_faces(self) -> usize {
        self.fewest_corners() + 1
    }
}

/// Most walls of a polyhedron: that many numbers of 32 bits stand for walls, and not for sites.
pub(crate) const MOST_WALLS: u16 = 1 << 15;

/// An axis-parallel box, or a rectangle in the plane z = 0, that may repeat periodically along some of its axes; or a convex
/// polyhedron, or polygon in the plane, whose bounding box that box is.
#[derive(Debug, Clone, PartialEq)]
pub struct Domain {
    lower: DVec3,
    upper: DVec3,
    dimension: Dimension,
    periodic: BVec3,
    polyhedron: Option<Arc<Polyhedron>>,
}

impl Domain {
    /// Lengths that a domain's sides may have, and half-spaces' distances from the origin up to the largest: products of six lengths, as
    /// shapes of triangles have them, stay numbers with all their digits.
    pub const LENGTHS: RangeInclusive<f64> = 1e-30..=1e30;

    /// A box in space from one corner to the opposite one.
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
        Self { lower: self.lower * factors, upper: self.upper * factors, ..self.clone() }
    }

    /// A rectangle in the plane z = 0; the z coordinates of the corners are ignored.
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
        let Extent { lower, upper, center } = Extent::of(&walls, dimension)?;
        check_sides(lower, upper, dimension)?;
        let flat = VoronoiError::FlatDomain { lower, upper };
        let mut domain = Self::cut_out_of_box(lower, upper, dimension, walls, name);
        if !domain.contains(center) {
            return Err(flat);
        }
        // The polyhedron is the cell of its only seed.
        let measure = Tessellation::new(&domain, &[center])?.cell_measures()[0].volume;
        if !(measure > 0.0 && measure.is_finite()) {
            return Err(flat);
        }
        if let Some(polyhedron) = &mut domain.polyhedron {
            let polyhedron = Arc::make_mut(polyhedron);
            (polyhedron.measure, polyhedron.center) = (measure, center);
        }
        Ok(domain)
    }

    /// A polyhedron whose volume is yet to be measured, in a box that holds it.
    pub(crate) fn cut_out_of_box(
        lower: DVec3,
        upper: DVec3,
        dimension: Dimension,
        walls: Vec<WallPlane>,
        name: Option<String>,
    ) -> Self {
        let normals: Vec<DVec3> = walls.iter().map(unit_normal).collect();
        let polyhedron = Polyhedron::new(walls, normals, lower.abs().max(upper.abs()), name);
        Self { polyhedron: Some(Arc::new(polyhedron)), ..Self::boxed(lower, upper, dimension) }
    }

    fn boxed(lower: DVec3, upper: DVec3, dimension: Dimension) -> Self {
        Self { lower, upper, dimension, periodic: BVec3::FALSE, polyhedron: None }
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
        Self { periodic: axes & in_domain, ..self }
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
        self.lower
    }

    /// The corner of the (bounding) box with the largest coordinates.
    pub fn upper(&self) -> DVec3 {
        self.upper
    }

    /// Side lengths of the (bounding) box; z is 0 in the plane.
    pub fn size(&self) -> DVec3 {
        self.upper - self.lower
    }

    /// A point inside: the middle of a box, the mean of a polyhedron's vertices.
    pub fn center(&self) -> DVec3 {
        let of_box = || self.lower + 0.5 * self.size();
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
        self.periodic
    }

    /// Whether the domain repeats along some axis.
    pub fn is_periodic(&self) -> bool {
        self.periodic.any()
    }

    /// Whether the domain is its box, and not a polyhedron in it.
    pub fn is_box(&self) -> bool {
        self.polyhedron.is_none()
    }

    /// The walls that bound the domain. Of a box six, or four in the plane, but for those across periodic axes; of a
    /// polyhedron all that it was given.
    pub fn walls(&self) -> impl Iterator<Item = Wall> {
        let periodic = self.periodic;
        let is_box = self.is_box();
        let count = if is_box { 2 * self.axes() } else { self.wall_planes().len() };
        let walls = (0u32..).take(count).map(Wall);
        walls.filter(move |wall| !is_box || !periodic.test(wall.axis()))
    }

    /// The walls of a polyhedron, by number; none for a box.
    pub fn wall_planes(&self) -> &[WallPlane] {
        self.polyhedron.as_ref().map_or(&[], |polyhedron| &polyhedron.walls)
    }

    /// Normals of the walls of a polyhedron.
    pub(crate) fn unit_normals(&self) -> &[DVec3] {
        self.polyhedron.as_ref().map_or(&[], |polyhedron| &polyhedron.normals)
    }

    /// Unit normal of a wall that points out of the domain.
    pub fn outward_normal(&self, wall: Wall) -> DVec3 {
        self.unit_normals().get(wall.index()).copied().unwrap_or_else(|| wall.outward_normal())
    }

    /// The plane of a wall: its unit outward normal, and the distance from the origin along it; rounded for an oblique wall.
    pub fn wall_equation(&self, wall: Wall) -> (DVec3, f64) {
        let normal = self.outward_normal(wall);
        let distance = match self.across_axis(wall) {
            Some((axis, coordinate)) => normal[axis] * coordinate,
            None => HalfSpace::of_wall(DVec3::ZERO, wall, self).offset,
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
        if wall.is_upper() { self.upper[wall.axis()] } else { self.lower[wall.axis()] }
    }

    /// Visits the walls of a polyhedron that may be up to a distance from a point, or have it beyond them, and some more.
    #[inline]
    pub(crate) fn for_each_wall_within(&self, point: DVec3, distance: f64, visit: impl FnMut(Wall)) {
        if let Some(polyhedron) = &self.polyhedron {
            polyhedron.for_each_wall_within(point, distance, visit);
        }
    }

    /// Where cells begin before anything cuts them: coordinate of a side of the box, of one thrice as large around a polyhedron.
    pub(crate) fn side_coordinate(&self, side: Wall) -> f64 {
        let axis = side.axis();
        let (lower, upper) = (self.lower[axis], self.upper[axis]);
        let room = if self.is_box() { 0.0 } else { upper - lower };
        if side.is_upper() { upper + room } else { lower - room }
    }

    /// A point moved by whole periods into the box.
    pub(crate) fn wrapped(&self, point: DVec3) -> DVec3 {
        let period = self.size();
        let below = self.periodic & point.cmplt(self.lower);
        let above = self.periodic & point.cmpge(self.upper);
        point + DVec3::select(below, period, DVec3::ZERO) - DVec3::select(above, period, DVec3::ZERO)
    }

    /// Whether a point lies in the domain or on its walls; exact.
    pub fn contains(&self, point: DVec3) -> bool {
        if self.is_box() {
            return point.cmpge(self.lower).all() && point.cmple(self.upper).all();
        }
        let mut is_inside = true;
        self.for_each_wall_within(point, 0.0, |wall| {
            let HalfSpace { offset, offset_size, .. } = HalfSpace::of_wall(point, wall, self);
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
                None => write!(formatter, "{} half-spaces in ", polyhedron.walls.len())?,
            }
        }
        // The box around a polyhedron is made of corners, which are rounded; its digits tell nothing.
        let shown = |coordinate: f64| {
            let six_digits = || format!("{coordinate:.5e}").parse().unwrap_or(coordinate);
            if self.is_box() { coordinate } else { six_digits() }
        };
        for axis in 0..self.axes() {
            let separator = if axis == 0 { "" } else { " x " };
            write!(formatter, "{separator}[{}, {}]", shown(self.lower[axis]), shown(self.upper[axis]))?;
        }
        Ok(())
    }
}
