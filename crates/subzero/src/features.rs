//! Creases, corners and boundaries: where a surface is not smooth.

/// A sharpness that never runs out; any value from here on means the same.
pub const INFINITE_SHARPNESS: f32 = 10.0;

/// An edge along which the surface is sharp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crease {
    /// The two vertices that the edge joins, in any order.
    pub ends: [u32; 2],
    /// How many levels the edge stays sharp; it falls by 1 a level, and stays from [`INFINITE_SHARPNESS`] on.
    pub sharpness: f32,
}

impl Crease {
    /// A crease that stays sharp at every level.
    pub fn infinite(ends: [u32; 2]) -> Self {
        Self { ends, sharpness: INFINITE_SHARPNESS }
    }
}

/// What happens at a boundary vertex that belongs to one triangle only; every boundary edge is a crease.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BoundaryRule {
    /// It is a crease vertex like its neighbours, and the boundary curve rounds it off.
    #[default]
    Edge,
    /// It is a corner and stays where it is.
    EdgeCorner,
}

/// The features of a triangle mesh; the default has none beyond its boundary.
///
/// ```
/// use subzero::{Crease, EdgeId, Features, TriangleMesh};
///
/// let creases = [Crease::infinite([0, 1])];
/// let features = Features { creases: &creases, corners: &[2], ..Features::default() };
/// let mesh = TriangleMesh::new(4, vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]], &features)?;
/// let is_crease = |edge: &u32| mesh.is_crease(EdgeId(*edge));
/// assert_eq!((0..6).filter(is_crease).count(), 1);
/// # Ok::<(), subzero::MeshError>(())
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Features<'a> {
    /// Sharp edges. Of two entries for one edge, the sharper holds.
    pub creases: &'a [Crease],
    /// Vertices that stay where they are.
    pub corners: &'a [u32],
    /// Vertices that stay where they are until their sharpness has run out, as `(vertex, sharpness)`; one of
    /// [`INFINITE_SHARPNESS`] is a corner.
    pub soft_corners: &'a [(u32, f32)],
    /// The rule for boundary vertices of a single triangle.
    pub boundary: BoundaryRule,
}

/// Which rule moves a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum VertexRule {
    /// No sharp edge: the mask of the surface (or of the curve).
    Smooth,
    /// One sharp edge, which ends here: moved like a smooth vertex.
    Dart,
    /// Two sharp edges: moved along the curve that they form.
    Crease,
    /// Fixed.
    Corner,
}
