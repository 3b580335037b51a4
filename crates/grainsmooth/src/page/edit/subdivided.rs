//! A mesh after some steps of a scheme.

use std::path::Path;

use glam::DVec3;
use subzero::{LoopHierarchy, LoopWeights, TriangleMesh};

use super::cage::{edges, triangles};
use super::drawing::Asked;
use crate::error::Error;
use crate::memory::{available_memory, check_levels};
use crate::mesh::file::MeshFile;
use crate::mesh::{Connectivity, Level, Scheme, grown_generations, subdivide};

/// A surface that follows from the points of a mesh.
#[derive(Debug)]
pub(super) enum Subdivided {
    /// By Loop's scheme. Its points can follow a control point.
    Loop { hierarchy: Box<LoopHierarchy>, levels: Vec<Vec<DVec3>>, generations: Option<Vec<i8>> },
    /// By another scheme that makes four triangles of each.
    Refined { base: Box<TriangleMesh>, steps: u32, last: Box<Level> },
    /// By a scheme on polygons, or no scheme at all.
    Surface(Surface),
}

/// Points and triangles.
#[derive(Debug, Default)]
pub(super) struct Surface {
    pub(super) points: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) edges: Vec<[u32; 2]>,
    pub(super) generations: Option<Vec<i8>>,
}

impl Subdivided {
    /// What a mesh becomes.
    ///
    /// # Errors
    /// As of [`subdivide`].
    pub(super) fn new(mesh: &MeshFile, path: &Path, asked: &Asked) -> Result<Option<Self>, Error> {
        let steps = asked.level;
        let Some(scheme) = Scheme::named(&asked.scheme).filter(|_| steps > 0) else { return Ok(None) };
        if let Scheme::Loop(weights) = scheme {
            return Self::by_loop(mesh, path, weights, asked).map(Some);
        }
        let mut levels = subdivide(mesh, path, scheme, steps)?;
        let Some(last) = levels.pop() else { return Ok(None) };
        if let Some(Connectivity::Triangles(base)) = levels.into_iter().next().map(|level| level.mesh) {
            return Ok(Some(Self::Refined { base: Box::new(base), steps, last: Box::new(last) }));
        }
        let faces = last.mesh.faces();
        Ok(Some(Self::Surface(Surface {
            triangles: triangles(&last.points, &faces),
            edges: edges(&faces),
            points: last.points,
            generations: last.generations,
        })))
    }

    fn by_loop(mesh: &MeshFile, path: &Path, weights: LoopWeights, asked: &Asked) -> Result<Self, Error> {
        let located = |problem| Error::MeshFile { path: path.to_owned(), problem };
        let base = Connectivity::Triangles(mesh.triangle_mesh().map_err(located)?);
        check_levels(base.size(), asked.level, available_memory())?;
        let Connectivity::Triangles(base) = base else { return Ok(Self::Surface(Surface::default())) };
        // The page finds the last level's triangles by itself; here they are needed for what is measured of them.
        let steps = asked.level as usize;
        let refinements = if asked.color.is_empty() { steps - 1 } else { steps };
        let hierarchy =
            LoopHierarchy::new(base, refinements, weights).map_err(|error| located(error.into()))?;
        let mut levels = if refinements < steps { hierarchy.buffers_beyond() } else { hierarchy.buffers() };
        hierarchy.apply_into(&mesh.points, &mut levels);
        let generations = (asked.color == "generation").then(|| {
            let own = mesh.generations().unwrap_or_else(|| vec![0; mesh.points.len()]);
            levels.iter().fold(own, |own, points| grown_generations(&own, points.len()))
        });
        Ok(Self::Loop { hierarchy: Box::new(hierarchy), levels, generations })
    }

    /// The points.
    pub(super) fn points(&self) -> &[DVec3] {
        match self {
            Self::Loop { levels, .. } => levels.last().map_or(&[], Vec::as_slice),
            Self::Refined { last, .. } => &last.points,
            Self::Surface(surface) => &surface.points,
        }
    }

    /// The mesh from whose triangles, by so many steps, those of the surface follow by index arithmetic.
    pub(super) fn base(&self) -> Option<(&TriangleMesh, u32)> {
        match self {
            // There were no more steps than a page asked for in 32 bits.
            Self::Loop { hierarchy, levels, .. } => {
                Some((&hierarchy.meshes()[0], u32::try_from(levels.len()).unwrap_or(u32::MAX)))
            }
            Self::Refined { base, steps, .. } => Some((base, *steps)),
            Self::Surface(_) => None,
        }
    }

    /// Number of triangles.
    pub(super) fn triangle_count(&self) -> usize {
        match self.base() {
            Some((base, steps)) => base.triangles().len() << (2 * steps),
            None => self.with_edges(|_, triangles| triangles.len()),
        }
    }

    /// What follows from the edges and triangles.
    pub(super) fn with_edges<T>(&self, work: impl FnOnce(&[[u32; 2]], &[[u32; 3]]) -> T) -> T {
        let of_mesh = |mesh: &TriangleMesh| (mesh.edges().collect::<Vec<_>>(), mesh.triangles().to_vec());
        let (edges, triangles) = match self {
            Self::Loop { hierarchy, .. } => of_mesh(hierarchy.finest()),
            Self::Refined { last, .. } => match &last.mesh {
                Connectivity::Triangles(mesh) => of_mesh(mesh),
                _ => Default::default(),
            },
            Self::Surface(surface) => return work(&surface.edges, &surface.triangles),
        };
        work(&edges, &triangles)
    }

    /// The level at which each point was born.
    pub(super) fn generations(&self) -> Option<&[i8]> {
        match self {
            Self::Loop { generations, .. } => generations.as_deref(),
            Self::Refined { last, .. } => last.generations.as_deref(),
            Self::Surface(surface) => surface.generations.as_deref(),
        }
    }

    /// Follows a control point that has moved: the points that do, by number and in order. Nothing where all is to be done again.
    pub(super) fn follow(&mut self, point: u32, control_points: &[DVec3]) -> Option<Vec<u32>> {
        let Self::Loop { hierarchy, levels, .. } = self else { return None };
        Some(hierarchy.apply_around(point, control_points, levels))
    }
}
