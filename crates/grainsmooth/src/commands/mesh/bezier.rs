//! Bezier curves and surfaces: sampled, merged, constructed.

use glam::DVec3;
use grainsmooth::mesh::construction_json;
use grainsmooth::mesh::file::{MeshFile, MeshFileProblem, MeshFormat, MeshToWrite, stage_mesh};
use grainsmooth::vtk::{Cells, DataArray};
use grainsmooth::{Error, Scene, bezier_json, mesh_json};
use subzero::{BezierError, MergedSurfaces};

use super::Job;
use super::files::scene_of_file;
use super::shown::Scenes;
use grainsmooth::cli::mesh::Merge;

impl Job<'_> {
    pub(super) fn bezier(&self, samples: u32) -> Result<(), Error> {
        let output = self.output(&self.files.output)?;
        let file = self.read_control_points()?;
        let (curves, surfaces) = (file.curves.len(), file.surfaces.len());
        if self.format != MeshFormat::Json && curves > 0 && surfaces > 0 {
            return Err(self.located(MeshFileProblem::CurvesAndSurfaces));
        }
        let located = |error: BezierError| self.located(error.into());
        let (mut points, lines) = file.polylines(samples).map_err(located)?;
        let (of_surfaces, normals, triangles) = file.triangles(samples).map_err(located)?;
        let first = u32::try_from(points.len()).unwrap_or(u32::MAX);
        points.extend(of_surfaces);
        let faces = triangles.iter().map(|triangle| triangle.map(|id| first + id).to_vec()).collect();
        let scene = Scene { points: points.clone(), faces, lines: lines.clone(), ..Scene::default() };
        let scenes = || {
            let shown = Scene { colors: self.colors(&[], &[])?, ..scene.clone() };
            Ok(Scenes { before: scene.clone(), levels: vec![shown] })
        };
        self.write(vec![output.path().to_owned()], scenes, |files| {
            if self.format == MeshFormat::Json {
                return output.stage(files, |out| bezier_json(&file, samples, out));
            }
            let content = match surfaces {
                0 => self.content(&points, Cells::Polylines(&lines)),
                _ => MeshToWrite {
                    normals: Some(&normals),
                    ..self.content(&points, Cells::Triangles(&triangles))
                },
            };
            stage_mesh(&content, &output, files)
        })
    }

    /// All surfaces of a file as one mesh.
    pub(super) fn merged(&self, samples: u32, merge: Merge) -> Result<(), Error> {
        let output = self.output(&self.files.output)?;
        let file = self.read_control_points()?;
        if file.surfaces.is_empty() {
            return Err(self.located(MeshFileProblem::NoSurfaces));
        }
        let merged =
            file.merged(samples, merge == Merge::Closed).map_err(|error| self.located(error.into()))?;
        let MergedSurfaces { seams, poles, filled, holes, .. } = merged;
        self.report(format_args!(
            "merged      {seams} seams and {poles} poles; {filled} holes filled, {holes} left: {} points, {} triangles",
            merged.points.len(),
            merged.triangles.len()
        ));
        let number = |surface: &Option<u32>| surface.map_or(-1, u32::cast_signed);
        let surfaces = [DataArray::int32("Surface", merged.surface_of.iter().map(number).collect())];
        let faces = merged.triangles.iter().map(|triangle| triangle.to_vec()).collect();
        let mesh = MeshFile { points: merged.points, faces, ..MeshFile::default() };
        let connectivity = mesh.polygon_mesh().map_err(|error| self.located(error))?;
        let normals = connectivity.vertex_normals(&mesh.points);
        let scenes = || {
            let shown = Scene { colors: self.colors(&[], &surfaces)?, ..scene_of_file(&mesh) };
            Ok(Scenes { before: scene_of_file(&mesh), levels: vec![shown] })
        };
        self.write(vec![output.path().to_owned()], scenes, |files| {
            if self.format == MeshFormat::Json {
                return output.stage(files, |out| mesh_json(&mesh, Some(&normals), out));
            }
            let normals: Vec<DVec3> = normals.iter().map(|normal| normal.unwrap_or_default()).collect();
            let content = self.content(&mesh.points, Cells::Triangles(&merged.triangles));
            let content = MeshToWrite { normals: Some(&normals), cell_data: &surfaces, ..content };
            stage_mesh(&content, &output, files)
        })
    }

    /// De Casteljau's points on all curves and surfaces of a file.
    pub(super) fn construction(&self, t: f64, v: f64) -> Result<(), Error> {
        let output = self.output(&self.files.output)?;
        let file = self.read_control_points()?;
        let all = file.construction(t, v).map_err(|error| self.located(error.into()))?;
        for curve in &file.curves {
            let DVec3 { x, y, z } = curve.point(t);
            self.report(format_args!("point       {x:?} {y:?} {z:?} after {} levels", curve.degree()));
        }
        for surface in &file.surfaces {
            let DVec3 { x, y, z } = surface.point(t, v);
            let (across, along) = (surface.rows()[0].degree(), surface.rows().len() - 1);
            self.report(format_args!(
                "point       {x:?} {y:?} {z:?} after {across} levels along v and {along} along u"
            ));
        }
        let scene = Scene {
            points: all.points.clone(),
            lines: all.lines.clone(),
            line_colors: all.line_levels.clone(),
            ..Scene::default()
        };
        let level = |levels: &Vec<i32>| [DataArray::int32("Level", levels.clone())];
        let (of_points, of_lines) = (level(&all.levels), level(&all.line_levels));
        let scenes = || {
            let shown = Scene { colors: self.colors(&of_points, &of_lines)?, ..scene.clone() };
            Ok(Scenes { before: scene.clone(), levels: vec![shown] })
        };
        self.write(vec![output.path().to_owned()], scenes, |files| {
            if self.format == MeshFormat::Json {
                return output.stage(files, |out| construction_json(&file, t, v, out));
            }
            let content = self.content(&all.points, Cells::Polylines(&all.lines));
            let content = MeshToWrite { point_data: &of_points, cell_data: &of_lines, ..content };
            stage_mesh(&content, &output, files)
        })
    }
}
