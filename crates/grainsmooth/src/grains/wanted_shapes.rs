//! The shapes that grains are to have.

use glam::{DMat3, DVec3};
use voronoi::Dimension;
use voronoi::volumes::GrainShape;

use crate::config::shapes::ShapeSource;
use crate::error::Error;
use crate::input::size_file::read_shape_file;

impl ShapeSource {
    /// The shapes of so many grains; `rotation` draws the direction of one.
    ///
    /// # Errors
    /// [`Error::Unreadable`]; [`Error::BadLine`], also where there are not as many lines as grains.
    pub(crate) fn shapes(
        &self,
        dimension: Dimension,
        count: usize,
        mut rotation: impl FnMut() -> DMat3,
    ) -> Result<Vec<GrainShape>, Error> {
        let spec = match self {
            Self::Alike(spec) => spec,
            Self::File(path) => {
                let shapes = read_shape_file(path, dimension)?;
                if shapes.len() == count {
                    return Ok(shapes);
                }
                let found = shapes.len();
                let problem =
                    format!("holds {found} shapes for {count} grains; give one for each, or --seeds {found}");
                return Err(Error::BadLine { path: path.clone(), line: 1, problem });
            }
        };
        let lengths = DVec3::new(spec.lengths[0], spec.lengths[1], *spec.lengths.get(2).unwrap_or(&1.0));
        let axes = || if spec.is_aligned { DMat3::IDENTITY } else { rotation() };
        Ok(std::iter::repeat_with(axes).map(|axes| GrainShape { lengths, axes }).take(count).collect())
    }
}
