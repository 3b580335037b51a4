//! What grains fill.

use glam::DVec3;
use voronoi::{Dimension, Domain};

use crate::input::domain_file::{half_space_domain, surface_domain};
use crate::{Config, Error, Shape};

impl Config {
    /// What the grains fill while they are computed, before [`Self::stretch`]; a box is that of [`LatticeFit::box_size`](crate::LatticeFit::box_size) for a lattice.
    ///
    /// # Errors
    /// [`Error::BoxSide`] when a side is not positive and finite, or beyond what doubles can compute with;
    /// whatever is wrong with the domain's file.
    pub fn domain(&self) -> Result<Domain, Error> {
        let axes = usize::from(self.dimension.axes());
        let sides = ['x', 'y', 'z'].into_iter().zip(self.box_size.to_array());
        if let Some((axis, length)) = sides.take(axes).find(|(_, length)| !Domain::LENGTHS.contains(length)) {
            return Err(Error::BoxSide { axis, length });
        }
        let center = 0.5 * self.box_size;
        match &self.shape {
            Shape::Box => {}
            Shape::Sphere { chord_error } => return Ok(Domain::ball(center, center.x, *chord_error)?),
            Shape::Cylinder { chord_error } => {
                return Ok(Domain::cylinder(center, center.x, self.box_size.z, *chord_error)?);
            }
            Shape::Disc { chord_error } => return Ok(Domain::disc(center, center.x, *chord_error)?),
            Shape::Surface(path) => return surface_domain(path),
            Shape::HalfSpaces(path) => return half_space_domain(path, self.dimension),
        }
        let upper = self.lattice_fit().map_or(self.box_size / self.stretch(), |fit| fit.box_size());
        let domain = match self.dimension {
            Dimension::Two => Domain::rectangle(DVec3::ZERO, upper)?,
            Dimension::Three => Domain::cuboid(DVec3::ZERO, upper)?,
        };
        Ok(domain.with_periods(self.periodic))
    }
}
