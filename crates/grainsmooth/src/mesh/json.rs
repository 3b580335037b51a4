//! Levels and limits as JSON, with the keys of the reference files of subdivision.
//!
//! Numbers have as many digits as it takes to read the same number back.

use std::io::{self, Write};

use glam::DVec3;
use serde::Serialize;
use subzero::{BezierCurve, BezierSurface, BoundaryRule, EdgeId, VertexRule};

use super::bezier::{BezierFile, grid, step};
use super::file::MeshFile;
use super::subdivide::{Connectivity, Level, Scheme, limits};

type Point = [f64; 3];
/// A normal, or three nulls where there is none.
type Normal = [Option<f64>; 3];

#[derive(Serialize)]
struct LevelsFile<'a> {
    scheme: &'static str,
    source: String,
    boundary: &'static str,
    vertices: &'a [Point],
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    faces: &'a [Vec<u32>],
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    lines: &'a [Vec<u32>],
    creases: Vec<(u32, u32, f32)>,
    corners: &'a [(u32, f32)],
    levels: Vec<LevelEntry<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    limits: Vec<LimitEntry>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    sector_normals_level0: Vec<SectorEntry>,
}

#[derive(Serialize)]
struct LevelEntry<'a> {
    level: usize,
    vertices: &'a [Point],
    /// The vertices of the level before that a vertex comes from: \[v, v\] its image, \[a, b\] on an edge, more in a face.
    #[serde(skip_serializing_if = "Option::is_none")]
    parents: Option<Vec<Vec<u32>>>,
    /// For Doo-Sabin: the face and the vertex of the level before that a vertex comes from.
    #[serde(skip_serializing_if = "Option::is_none")]
    corners: Option<Vec<[u32; 2]>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    faces: Vec<Vec<u32>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    lines: Vec<Vec<u32>>,
    #[serde(flatten)]
    face_limits: Option<FaceLimits>,
}

#[derive(Serialize)]
struct FaceLimits {
    limit_face_point: Vec<Point>,
    limit_face_normal: Vec<Normal>,
}

#[derive(Serialize)]
struct LimitEntry {
    level: usize,
    kind: Vec<u8>,
    position_exact: Vec<Point>,
    normal_exact: Vec<Normal>,
}

#[derive(Serialize)]
struct SectorEntry {
    v: u32,
    ring: Vec<u32>,
    normal: Normal,
}

/// Writes the levels of a mesh: level 0 as `vertices` and `faces`, the others as `levels` with `parents`, and the `limits`
/// of all levels whose sharpness has run out.
///
/// # Errors
/// Whatever `out` reports.
pub fn levels_json(mesh: &MeshFile, scheme: Scheme, levels: &[Level], out: &mut dyn Write) -> io::Result<()> {
    let limits: Vec<_> = levels
        .iter()
        .enumerate()
        // A level that is still semi-sharp has no limits yet.
        .filter_map(|(index, level)| limits(level, scheme).ok().flatten().map(|found| (index, found)))
        .collect();
    let is_curve = matches!(scheme, Scheme::BSpline | Scheme::FourPoint);
    let sectors = limits.iter().filter(|(level, _)| *level == 0).flat_map(|(_, found)| &found.sectors);
    let file = LevelsFile {
        scheme: scheme.reference_name(),
        source: format!("grainsmooth {}", env!("CARGO_PKG_VERSION")),
        boundary: boundary(mesh.boundary),
        vertices: bytemuck::cast_slice(&mesh.points),
        faces: if is_curve { &[] } else { &mesh.faces },
        lines: if is_curve { &mesh.lines } else { &[] },
        creases: creases(mesh),
        corners: &mesh.corners,
        levels: levels
            .windows(2)
            .enumerate()
            .map(|(index, pair)| level_entry(scheme, index + 1, pair))
            .collect(),
        sector_normals_level0: sectors
            .map(|(v, ring, normal)| SectorEntry { v: *v, ring: ring.clone(), normal: nullable(*normal) })
            .collect(),
        limits: limits
            .iter()
            .map(|(index, found)| LimitEntry {
                level: *index,
                kind: kinds(&levels[*index].mesh),
                position_exact: found.positions.iter().map(DVec3::to_array).collect(),
                normal_exact: found.normals.iter().copied().map(nullable).collect(),
            })
            .collect(),
    };
    serde_json::to_writer(out, &file).map_err(io::Error::from)
}

fn boundary(rule: BoundaryRule) -> &'static str {
    match rule {
        BoundaryRule::Edge => "edge",
        BoundaryRule::EdgeCorner => "edge_corner",
    }
}

fn creases(mesh: &MeshFile) -> Vec<(u32, u32, f32)> {
    mesh.creases.iter().map(|crease| (crease.ends[0], crease.ends[1], crease.sharpness)).collect()
}

fn level_entry(scheme: Scheme, index: usize, pair: &[Level]) -> LevelEntry<'_> {
    let [coarse, fine] = [&pair[0], &pair[1]];
    // Doo and Sabin's scheme keeps no vertex: it makes one for each corner.
    let is_dual = matches!(scheme, Scheme::DooSabin(_));
    let is_curve = matches!(fine.mesh, Connectivity::Curves(_));
    let face_limits = match &fine.mesh {
        Connectivity::Polygons(mesh) if is_dual => {
            let limits = mesh.doo_sabin_limits();
            Some(FaceLimits {
                limit_face_point: limits.positions.apply(&fine.points).iter().map(DVec3::to_array).collect(),
                limit_face_normal: limits.normals(&fine.points).into_iter().map(nullable).collect(),
            })
        }
        _ => None,
    };
    LevelEntry {
        level: index,
        vertices: bytemuck::cast_slice(&fine.points),
        parents: (!is_dual).then(|| parents(&coarse.mesh)),
        corners: is_dual.then(|| corners(&coarse.mesh)),
        faces: if is_curve { Vec::new() } else { fine.mesh.faces() },
        lines: if is_curve { fine.mesh.faces() } else { Vec::new() },
        face_limits,
    }
}

/// The parents of the vertices that come after a mesh: those of its vertices, its edges and, where there are more, its faces.
fn parents(mesh: &Connectivity) -> Vec<Vec<u32>> {
    match mesh {
        Connectivity::Triangles(mesh) => {
            let edges = mesh.edges().map(Vec::from);
            (0..mesh.counts().vertices).map(|v| vec![v, v]).chain(edges).collect()
        }
        Connectivity::Polygons(mesh) => {
            let vertices = ids(mesh.vertex_count()).map(|v| vec![v, v]);
            let edges = mesh.edges().map(Vec::from);
            vertices.chain(edges).chain(mesh.faces().map(<[u32]>::to_vec)).collect()
        }
        Connectivity::Curves(curves) => {
            let vertices = ids(curves.mesh.vertex_count()).map(|v| vec![v, v]);
            vertices.chain(curves.mesh.segments().iter().map(|ends| ends.to_vec())).collect()
        }
    }
}

/// Face and vertex of each corner.
fn corners(mesh: &Connectivity) -> Vec<[u32; 2]> {
    let faces = mesh.faces();
    let corners = ids(faces.len()).zip(&faces).flat_map(|(f, face)| face.iter().map(move |&v| [f, v]));
    corners.collect()
}

/// 0 smooth, 1 dart, 2 boundary crease, 3 corner, 4 inner crease, 5 on an edge of three or more faces.
fn kinds(mesh: &Connectivity) -> Vec<u8> {
    let (vertex_count, counts): (usize, Vec<([u32; 2], u32)>) = match mesh {
        Connectivity::Triangles(mesh) => {
            let counts = mesh.edge_triangle_counts();
            (mesh.vertex_count(), mesh.edges().zip(counts).collect())
        }
        Connectivity::Polygons(mesh) => {
            let faces = |edge| if mesh.is_boundary(EdgeId(edge)) { 1 } else { 2 };
            (mesh.vertex_count(), mesh.edges().zip((0..).map(faces)).collect())
        }
        Connectivity::Curves(curves) => (curves.mesh.vertex_count(), Vec::new()),
    };
    let mut on_boundary = vec![false; vertex_count];
    let mut on_junction = vec![false; vertex_count];
    for (ends, count) in counts {
        for end in ends.map(|end| end as usize) {
            on_boundary[end] |= count == 1;
            on_junction[end] |= count > 2;
        }
    }
    let kind = |v: u32| match mesh.vertex_rule(v) {
        VertexRule::Smooth => 0,
        VertexRule::Dart => 1,
        _ if on_junction[v as usize] => 5,
        VertexRule::Crease if on_boundary[v as usize] => 2,
        VertexRule::Crease => 4,
        VertexRule::Corner => 3,
    };
    ids(vertex_count).map(kind).collect()
}

/// The ids of so many elements; meshes are refused that have more than ids can count.
fn ids(count: usize) -> std::ops::Range<u32> {
    0..u32::try_from(count).unwrap_or(u32::MAX)
}

fn nullable(normal: Option<DVec3>) -> Normal {
    normal.map_or([None; 3], |normal| normal.to_array().map(Some))
}

#[derive(Serialize)]
struct PlainFile<'a> {
    source: String,
    boundary: &'static str,
    vertices: &'a [Point],
    faces: &'a [Vec<u32>],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    creases: Vec<(u32, u32, f32)>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    corners: &'a [(u32, f32)],
    #[serde(skip_serializing_if = "Option::is_none")]
    normals: Option<Vec<Normal>>,
}

/// Writes a single mesh, and its normals if there are any; it can be read again.
///
/// # Errors
/// Whatever `out` reports.
pub fn mesh_json(mesh: &MeshFile, normals: Option<&[Option<DVec3>]>, out: &mut dyn Write) -> io::Result<()> {
    let file = PlainFile {
        source: format!("grainsmooth {}", env!("CARGO_PKG_VERSION")),
        boundary: boundary(mesh.boundary),
        vertices: bytemuck::cast_slice(&mesh.points),
        faces: &mesh.faces,
        creases: creases(mesh),
        corners: &mesh.corners,
        normals: normals.map(|normals| normals.iter().copied().map(nullable).collect()),
    };
    serde_json::to_writer(out, &file).map_err(io::Error::from)
}

#[derive(Serialize)]
struct BezierJson {
    source: String,
    curves: Vec<CurveEntry>,
    surfaces: Vec<SurfaceEntry>,
}

#[derive(Serialize)]
struct CurveEntry {
    degree: usize,
    control: Vec<Point>,
    t: Vec<f64>,
    point: Vec<Point>,
    derivative: Vec<Point>,
}

#[derive(Serialize)]
struct SurfaceEntry {
    control: Vec<Vec<Point>>,
    uv: Vec<[f64; 2]>,
    point: Vec<Point>,
    du: Vec<Point>,
    dv: Vec<Point>,
}

/// Writes `samples` points of each curve and `samples` x `samples` of each surface, with parameters and derivatives.
///
/// # Errors
/// Whatever `out` reports.
pub fn bezier_json(file: &BezierFile, samples: u32, out: &mut dyn Write) -> io::Result<()> {
    let arrays = |points: &[DVec3]| points.iter().map(DVec3::to_array).collect();
    let t: Vec<f64> = (0..samples).map(|i| step(i, samples)).collect();
    let curve = |curve: &BezierCurve<DVec3>| CurveEntry {
        degree: curve.degree(),
        control: arrays(curve.control()),
        point: t.iter().map(|&t| curve.point(t).to_array()).collect(),
        derivative: t.iter().map(|&t| curve.derivative(t).to_array()).collect(),
        t: t.clone(),
    };
    let uv: Vec<[f64; 2]> = grid(samples).collect();
    let surface = |(surface, control): (&BezierSurface<DVec3>, &Vec<Vec<DVec3>>)| {
        let derivatives: Vec<[DVec3; 2]> = uv.iter().map(|&[u, v]| surface.derivatives(u, v)).collect();
        SurfaceEntry {
            control: control.iter().map(|row| arrays(row)).collect(),
            point: uv.iter().map(|&[u, v]| surface.point(u, v).to_array()).collect(),
            du: derivatives.iter().map(|derivatives| derivatives[0].to_array()).collect(),
            dv: derivatives.iter().map(|derivatives| derivatives[1].to_array()).collect(),
            uv: uv.clone(),
        }
    };
    let json = BezierJson {
        source: format!("grainsmooth {}", env!("CARGO_PKG_VERSION")),
        curves: file.curves.iter().map(curve).collect(),
        surfaces: file.surfaces.iter().zip(&file.surface_control).map(surface).collect(),
    };
    serde_json::to_writer(out, &json).map_err(io::Error::from)
}

#[derive(Serialize)]
struct ConstructionJson {
    source: String,
    t: f64,
    v: f64,
    curves: Vec<ConstructedCurve>,
    surfaces: Vec<ConstructedSurface>,
}

#[derive(Serialize)]
struct ConstructedSurface {
    /// Of each row, from its control points down to the point at v.
    rows: Vec<Vec<Vec<Point>>>,
    /// From these points, along u, down to the point on the surface.
    levels: Vec<Vec<Point>>,
    point: Point,
    du: Point,
    dv: Point,
}

#[derive(Serialize)]
struct ConstructedCurve {
    degree: usize,
    control: Vec<Point>,
    /// From the control points down to the point on the curve.
    levels: Vec<Vec<Point>>,
    point: Point,
    derivative: Point,
    /// Control points of the curve before `t`, and after it.
    left: Vec<Point>,
    right: Vec<Point>,
}

/// Writes de Casteljau's points of each curve at `t`, level by level, with the curve's point and derivative there and the control points
/// of its two parts; and those of each surface at (`t`, `v`), with its point and derivatives there.
///
/// # Errors
/// Whatever `out` reports.
pub fn construction_json(file: &BezierFile, t: f64, v: f64, out: &mut dyn Write) -> io::Result<()> {
    let arrays = |points: &[DVec3]| points.iter().map(DVec3::to_array).collect();
    let levels =
        |curve: &BezierCurve<DVec3>, t| curve.casteljau(t).iter().map(|level| arrays(level)).collect();
    let curve = |curve: &BezierCurve<DVec3>| {
        let [left, right] = curve.split(t);
        ConstructedCurve {
            degree: curve.degree(),
            control: arrays(curve.control()),
            levels: levels(curve, t),
            point: curve.point(t).to_array(),
            derivative: curve.derivative(t).to_array(),
            left: arrays(left.control()),
            right: arrays(right.control()),
        }
    };
    let surface = |surface: &BezierSurface<DVec3>| {
        let [du, dv] = surface.derivatives(t, v).map(|derivative| derivative.to_array());
        ConstructedSurface {
            rows: surface.rows().iter().map(|row| levels(row, v)).collect(),
            levels: levels(&surface.curve_along_u(v), t),
            point: surface.point(t, v).to_array(),
            du,
            dv,
        }
    };
    let json = ConstructionJson {
        source: format!("grainsmooth {}", env!("CARGO_PKG_VERSION")),
        t,
        v,
        curves: file.curves.iter().map(curve).collect(),
        surfaces: file.surfaces.iter().map(surface).collect(),
    };
    serde_json::to_writer(out, &json).map_err(io::Error::from)
}
