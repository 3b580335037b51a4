//! Subdivision of a mesh by any scheme, with all its levels.

use glam::DVec3;
use subzero::{
    CurveMesh, DooSabinWeights, EdgeId, FaceId, LoopWeights, MeshError, PolygonMesh, Refinement,
    StencilTable, TriangleMesh, VertexRule,
};

use super::data::{NORMALS, averaged, is_of_shape};
use super::file::{MeshFile, MeshFileProblem};
use crate::Error;
use crate::memory::{LevelSize, available_memory, check_levels};
use crate::names::GENERATION;
use crate::vtk::{DataArray, DataNumbers};

/// A scheme of subdivision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scheme {
    /// Loop's, on triangles.
    Loop(LoopWeights),
    /// Butterfly, on triangles; interpolating.
    Butterfly,
    /// Modified butterfly, on triangles; interpolating.
    ModifiedButterfly,
    /// Midpoints, on triangles: the surface stays as it is.
    Midpoint,
    /// Doo and Sabin's, on polygons.
    DooSabin(DooSabinWeights),
    /// Catmull and Clark's, on polygons.
    CatmullClark,
    /// Cubic B-splines, on polylines.
    BSpline,
    /// Dyn, Levin and Gregory's, on polylines; interpolating.
    FourPoint,
}

/// The schemes by their names on the command line, with those in the reference files of subdivision.
const SCHEMES: [(&str, &str, Scheme); 8] = [
    ("loop", "loop", Scheme::Loop(LoopWeights::Loop)),
    ("butterfly", "butterfly", Scheme::Butterfly),
    ("modified-butterfly", "modified butterfly", Scheme::ModifiedButterfly),
    ("midpoint", "midpoint", Scheme::Midpoint),
    ("doo-sabin", "doo-sabin", Scheme::DooSabin(DooSabinWeights::DooSabin)),
    ("catmull-clark", "catmull-clark", Scheme::CatmullClark),
    ("b-spline", "cubic b-spline", Scheme::BSpline),
    ("four-point", "four-point", Scheme::FourPoint),
];

impl Scheme {
    /// The scheme of a name on the command line, with its usual weights.
    pub(crate) fn named(name: &str) -> Option<Self> {
        SCHEMES.into_iter().find(|(known, ..)| *known == name).map(|(.., scheme)| scheme)
    }

    /// Its name in the reference files of subdivision.
    pub(crate) fn reference_name(self) -> &'static str {
        let is_same = |other: &Self| std::mem::discriminant(&self) == std::mem::discriminant(other);
        SCHEMES.iter().find(|(.., scheme)| is_same(scheme)).map_or("", |(_, name, _)| name)
    }
}

/// Connectivity of one level.
#[derive(Debug, Clone, PartialEq)]
pub enum Connectivity {
    /// Of the triangle schemes.
    Triangles(TriangleMesh),
    /// Of the polygon schemes.
    Polygons(PolygonMesh),
    /// Of the schemes of curves.
    Curves(Curves),
}

/// Polylines and how they join.
#[derive(Debug, Clone, PartialEq)]
pub struct Curves {
    /// The segments of all polylines, one after the other.
    pub mesh: CurveMesh,
    /// The points of each polyline, in order along it; where it is closed, the first comes again at the end.
    pub lines: Vec<Vec<u32>>,
}

/// A mesh after some steps of subdivision.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// Its connectivity.
    pub mesh: Connectivity,
    /// Its points.
    pub points: Vec<DVec3>,
    /// For each point the level at which it was born; nothing in Doo and Sabin's scheme, whose points are all new.
    pub generations: Option<Vec<i8>>,
    /// Arrays of points: of the first level those of the file, of others means.
    pub point_data: Vec<DataArray>,
    /// For each face (of curves, each polyline) that of the file in which it lies; nothing where faces come from several.
    pub cell_of: Option<Vec<u32>>,
}

/// Where the vertices of a level end up on the limit surface, and its unit normals there.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Limits {
    /// A position for each vertex.
    pub positions: Vec<DVec3>,
    /// A normal for each vertex; nothing where there is none, or more than one.
    pub normals: Vec<Option<DVec3>>,
    /// For Loop's scheme at vertices that are not smooth: vertex, neighbours counter-clockwise from crease to crease,
    /// and the normal of the piece of surface between them.
    pub sectors: Vec<(u32, Vec<u32>, Option<DVec3>)>,
}

/// Subdivides a mesh `levels` times; the first of the levels returned is the mesh itself.
///
/// ```
/// use std::path::Path;
///
/// use grainsmooth::mesh::file::read_mesh;
/// use grainsmooth::{Scheme, subdivide};
///
/// let path = Path::new("data/cube.obj");
/// let levels = subdivide(&read_mesh(path)?, path, Scheme::CatmullClark, 2)?;
/// assert_eq!(levels.iter().map(|level| level.points.len()).collect::<Vec<_>>(), [8, 26, 98]);
/// # Ok::<(), grainsmooth::Error>(())
/// ```
///
/// # Errors
/// [`MeshFileProblem::NotATriangle`] or [`MeshFileProblem::Mesh`] where the scheme cannot work with the mesh, in
/// [`Error::MeshFile`], which names `path`; [`LevelsExceedMemory`](crate::memory::MemoryError::LevelsExceedMemory) or [`LevelsExceedIds`](crate::memory::MemoryError::LevelsExceedIds).
pub fn subdivide(
    mesh: &MeshFile,
    path: &std::path::Path,
    scheme: Scheme,
    levels: u32,
) -> Result<Vec<Level>, Error> {
    let located = |problem| Error::MeshFile { path: path.to_owned(), problem };
    let connectivity = match scheme {
        Scheme::DooSabin(_) | Scheme::CatmullClark => {
            Connectivity::Polygons(mesh.polygon_mesh().map_err(located)?)
        }
        Scheme::BSpline | Scheme::FourPoint => {
            let lines = mesh.lines.clone();
            Connectivity::Curves(Curves { mesh: mesh.curve_mesh().map_err(located)?, lines })
        }
        _ => Connectivity::Triangles(mesh.triangle_mesh().map_err(located)?),
    };
    check_levels(connectivity.size(), levels, available_memory())?;
    let mut all = vec![Level::of_file(mesh, connectivity)];
    for _ in 0..levels {
        let finer = all[all.len() - 1].refine(scheme).map_err(|error| located(error.into()))?;
        all.push(finer);
    }
    Ok(all)
}

/// The levels at which the points of a finer mesh were born, of which there are so many: the old ones first.
pub(crate) fn grown_generations(generations: &[i8], points: usize) -> Vec<i8> {
    let next = generations.iter().copied().max().unwrap_or(0).saturating_add(1);
    let mut grown = generations.to_vec();
    grown.resize(points, next);
    grown
}

impl Level {
    /// The level at which each point was born, as an array.
    pub fn generation_array(&self) -> Option<DataArray> {
        let numbers = DataNumbers::Int8(self.generations.clone()?);
        Some(DataArray { name: GENERATION.to_owned(), components: 1, numbers })
    }

    /// The mesh of a file itself.
    fn of_file(file: &MeshFile, mesh: Connectivity) -> Self {
        let cells = if matches!(mesh, Connectivity::Curves(_)) { file.lines.len() } else { file.faces.len() };
        let is_other = |array: &&DataArray| ![GENERATION, NORMALS].contains(&array.name.as_str());
        Self {
            generations: Some(file.generations().unwrap_or_else(|| vec![0; file.points.len()])),
            point_data: file.point_data.iter().filter(is_other).cloned().collect(),
            cell_of: Some((0..).take(cells).collect()),
            points: file.points.clone(),
            mesh,
        }
    }

    fn refine(&self, scheme: Scheme) -> Result<Self, MeshError> {
        let (mesh, stencils) = self.refine_mesh(scheme)?;
        let points = stencils.apply(&self.points);
        let is_dual = matches!(scheme, Scheme::DooSabin(_));
        let generations = self.generations.as_ref().filter(|_| !is_dual);
        let generations = generations.map(|levels| grown_generations(levels, points.len()));
        let keeps_shape = scheme == Scheme::Midpoint;
        let of_points = self.point_data.iter().filter(|array| keeps_shape || !is_of_shape(&array.name));
        let point_data = of_points.filter_map(|array| averaged(array, &stencils)).collect();
        let parents = self.mesh.parents_of_finer(scheme);
        let cell_of = self
            .cell_of
            .as_ref()
            .zip(parents)
            .map(|(cells, parents)| parents.into_iter().map(|parent| cells[parent as usize]).collect());
        Ok(Self { mesh, points, generations, point_data, cell_of })
    }

    fn refine_mesh(&self, scheme: Scheme) -> Result<(Connectivity, StencilTable), MeshError> {
        match &self.mesh {
            Connectivity::Triangles(mesh) => {
                let Refinement { mesh, stencils } = match scheme {
                    Scheme::Loop(weights) => mesh.loop_refine_with(weights)?,
                    Scheme::Butterfly => mesh.butterfly_refine()?,
                    Scheme::ModifiedButterfly => mesh.modified_butterfly_refine()?,
                    _ => mesh.midpoint_refine()?,
                };
                Ok((Connectivity::Triangles(mesh), stencils))
            }
            Connectivity::Polygons(mesh) => {
                let Refinement { mesh, stencils } = match scheme {
                    Scheme::DooSabin(weights) => mesh.doo_sabin_refine(weights)?,
                    _ => mesh.catmull_clark_refine()?,
                };
                Ok((Connectivity::Polygons(mesh), stencils))
            }
            Connectivity::Curves(curves) => {
                let Refinement { mesh, stencils } = match scheme {
                    Scheme::FourPoint => curves.mesh.four_point_refine()?,
                    _ => curves.mesh.refine()?,
                };
                let curves = Curves { lines: curves.finer_lines(), mesh };
                Ok((Connectivity::Curves(curves), stencils))
            }
        }
    }
}

impl Curves {
    /// The polylines after a refinement: between two points now stands that of their segment.
    fn finer_lines(&self) -> Vec<Vec<u32>> {
        let vertex_count = self.mesh.vertex_count();
        // More than ids can count is refused before.
        let mut middles = (0..).skip(vertex_count);
        let mut finer = |line: &Vec<u32>| {
            let mut points = Vec::with_capacity(2 * line.len() - 1);
            for &end in &line[1..] {
                points.extend(middles.next().map(|middle| [middle, end]).into_iter().flatten());
            }
            points.insert(0, line[0]);
            points
        };
        self.lines.iter().map(&mut finer).collect()
    }
}

impl Connectivity {
    /// For each face (of curves, each polyline) of the next level that in which it lies; nothing in Doo and Sabin's scheme, where
    /// faces come from edges and points too.
    fn parents_of_finer(&self, scheme: Scheme) -> Option<Vec<u32>> {
        match self {
            Self::Triangles(mesh) => {
                let counts = mesh.counts();
                let triangles = (0..).take(4 * mesh.triangles().len());
                Some(triangles.map(|triangle| counts.triangle_parent(FaceId(triangle)).0).collect())
            }
            Self::Polygons(_) if matches!(scheme, Scheme::DooSabin(_)) => None,
            Self::Polygons(mesh) => {
                let faces = (0..).zip(mesh.faces());
                Some(faces.flat_map(|(face, corners)| std::iter::repeat_n(face, corners.len())).collect())
            }
            Self::Curves(curves) => Some((0..).take(curves.lines.len()).collect()),
        }
    }

    /// The faces as lists of vertices; of curves, the polylines.
    pub fn faces(&self) -> Vec<Vec<u32>> {
        match self {
            Self::Triangles(mesh) => mesh.triangles().iter().map(|triangle| triangle.to_vec()).collect(),
            Self::Polygons(mesh) => mesh.faces().map(<[u32]>::to_vec).collect(),
            Self::Curves(curves) => curves.lines.clone(),
        }
    }

    /// Number of faces; of curves, of segments.
    pub fn face_count(&self) -> usize {
        match self {
            Self::Triangles(mesh) => mesh.triangles().len(),
            Self::Polygons(mesh) => mesh.face_count(),
            Self::Curves(curves) => curves.mesh.segments().len(),
        }
    }

    /// Checks that no edge lies on a boundary, and no polyline has ends.
    ///
    /// # Errors
    /// [`MeshError::Open`] names the first edge with one face only, [`MeshFileProblem::OpenPolyline`] the first polyline.
    pub fn check_closed(&self) -> Result<(), MeshFileProblem> {
        match self {
            Self::Triangles(mesh) => Ok(mesh.check_closed()?),
            Self::Polygons(mesh) => {
                let open = (0..).zip(mesh.edges()).find(|(edge, _)| mesh.is_boundary(EdgeId(*edge)));
                open.map_or(Ok(()), |(_, ends)| Err(MeshError::Open { ends }.into()))
            }
            Self::Curves(curves) => match curves.lines.iter().position(|line| line.first() != line.last()) {
                Some(line) => Err(MeshFileProblem::OpenPolyline { line }),
                None => Ok(()),
            },
        }
    }

    /// The rule that moves a vertex.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn vertex_rule(&self, vertex: u32) -> VertexRule {
        match self {
            Self::Triangles(mesh) => mesh.vertex_rule(vertex),
            Self::Polygons(mesh) => mesh.vertex_rule(vertex),
            Self::Curves(curves) => curves.mesh.vertex_rule(vertex),
        }
    }

    /// The size for an estimate of memory; polygons count as if cut into triangles from their middles, which grow as
    /// fast under the triangle schemes as polygons do under theirs.
    pub(crate) fn size(&self) -> LevelSize {
        let [points, edges, triangles] = match self {
            Self::Triangles(mesh) => [mesh.vertex_count(), mesh.edge_count(), mesh.triangles().len()],
            Self::Polygons(mesh) => {
                let corners = mesh.faces().map(<[u32]>::len).sum::<usize>();
                [mesh.vertex_count() + mesh.face_count(), mesh.edge_count() + corners, corners]
            }
            Self::Curves(curves) => [curves.mesh.vertex_count(), curves.mesh.segments().len(), 0],
        }
        .map(|count| count as u128);
        LevelSize { points, edges, triangles }
    }
}

/// The limits of a level of Loop's scheme, Catmull and Clark's or cubic B-splines; nothing for the other schemes.
///
/// # Errors
/// [`MeshError::SemiSharp`] while a sharpness has not run out.
pub fn limits(level: &Level, scheme: Scheme) -> Result<Option<Limits>, MeshFileProblem> {
    match (&level.mesh, scheme) {
        (Connectivity::Triangles(mesh), Scheme::Loop(weights)) => {
            let limits = mesh.loop_limits(weights)?;
            let normals = limits.sector_normals(&level.points).into_iter();
            let sectors = limits.sectors.iter().zip(normals);
            Ok(Some(Limits {
                positions: limits.project(&level.points),
                normals: limits.vertex_normals(&level.points),
                sectors: sectors
                    .filter(|(sector, _)| is_at_crease(mesh.vertex_rule(sector.vertex)))
                    .map(|(sector, normal)| (sector.vertex, mesh.sector_ring(*sector), normal))
                    .collect(),
            }))
        }
        (Connectivity::Polygons(mesh), Scheme::CatmullClark) => {
            let limits = mesh.catmull_clark_limits()?;
            let normals = limits.sector_normals(&level.points).into_iter();
            let sectors = limits.sectors.iter().zip(normals);
            Ok(Some(Limits {
                positions: limits.positions.apply(&level.points),
                normals: limits.vertex_normals(&level.points),
                sectors: sectors
                    .filter(|(sector, _)| is_at_crease(mesh.vertex_rule(sector.vertex)))
                    .map(|(sector, normal)| (sector.vertex, mesh.sector_ring(*sector), normal))
                    .collect(),
            }))
        }
        (Connectivity::Curves(curves), Scheme::BSpline) => Ok(Some(Limits {
            positions: curves.mesh.limit_positions().apply(&level.points),
            normals: vec![None; level.points.len()],
            sectors: Vec::new(),
        })),
        _ => Ok(None),
    }
}

/// Whether the surface around a vertex falls into sectors.
fn is_at_crease(rule: VertexRule) -> bool {
    matches!(rule, VertexRule::Crease | VertexRule::Corner)
}
