//! What is read and written, and what is said of it.

use std::collections::BTreeMap;
use std::path::PathBuf;

use glam::DVec3;
use grainsmooth::mesh::CarriedData;
use grainsmooth::mesh::file::{
    MeshFile, MeshFileProblem, MeshFormat, MeshToWrite, read_mesh, read_polylines, stage_mesh,
};
use grainsmooth::vtk::{Cells, DataArray};
use grainsmooth::{
    BezierFile, Connectivity, Counted, Error, Level, Output, Scene, SceneColors, SceneNumbers, StagedFiles,
    mesh_json, read_bezier, write_together,
};
use subzero::INFINITE_SHARPNESS;

use super::Job;
use super::shown::Scenes;
use grainsmooth::cli::mesh::Features;

impl Job<'_> {
    /// Writes the files of a run, with its picture and its page, so that all appear together.
    pub(super) fn write(
        &self,
        written: Vec<PathBuf>,
        scenes: impl FnOnce() -> Result<Scenes, Error>,
        stage: impl FnOnce(&mut StagedFiles) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let scenes = self.shown.is_any().then(scenes).transpose()?;
        write_together(|files| {
            stage(files)?;
            match &scenes {
                Some(scenes) => self.shown.stage(scenes, &self.command_line, &self.report.borrow(), files),
                None => Ok(()),
            }
        })?;
        for path in written.iter().map(PathBuf::as_path).chain(self.shown.paths()) {
            self.report(format_args!("written     {}", path.display()));
        }
        Ok(())
    }

    pub(super) fn read_control_points(&self) -> Result<BezierFile, Error> {
        let file = read_bezier(&self.files.input)?;
        let (curves, surfaces) = (file.curves.len(), file.surfaces.len());
        let [curves, surfaces] =
            [(curves, "curve"), (surfaces, "surface")].map(|(count, of)| Counted(count, of));
        self.report(format_args!("read        {curves} and {surfaces}"));
        Ok(file)
    }

    /// The surface, without polylines that the file may have.
    pub(super) fn read(&self) -> Result<MeshFile, Error> {
        let mut mesh = read_mesh(&self.files.input)?;
        let points = mesh.points.len();
        self.report_read(points, [(mesh.faces.len(), "faces"), (mesh.lines.len(), "polylines")]);
        mesh.lines.clear();
        if let Some(corners) = mesh.merged_corners {
            self.report(format_args!(
                "merged      {corners} corners with exactly equal coordinates to {points} points"
            ));
        }
        Ok(mesh)
    }

    /// The polylines, without faces that the file may have.
    pub(super) fn read_lines(&self) -> Result<MeshFile, Error> {
        let mut mesh = read_polylines(&self.files.input)?;
        self.report_read(mesh.points.len(), [(mesh.lines.len(), "polylines"), (mesh.faces.len(), "faces")]);
        mesh.faces.clear();
        Ok(mesh)
    }

    /// Says how many parts there are of a kind, and how many of another that are left out.
    fn report_read(&self, points: usize, [(count, kind), (others, other)]: [(usize, &str); 2]) {
        self.report(format_args!("read        {points} points, {count} {kind}"));
        if others > 0 {
            self.report(format_args!("dropped     {others} {other} beside the {kind}"));
        }
    }

    /// The mesh or polylines, with the creases and corners of the command line beside those of the file.
    pub(super) fn read_with(&self, features: Features<'_>) -> Result<MeshFile, Error> {
        match features {
            Features::OfSurface(features) => {
                let mut mesh = self.read()?;
                mesh.creases.extend(&features.creases);
                mesh.corners.extend(&features.corners);
                if let Some(boundary) = features.boundary {
                    mesh.boundary = boundary;
                }
                Ok(mesh)
            }
            Features::OfCurves { corners } => {
                let mut mesh = self.read_lines()?;
                mesh.corners.extend(corners.iter().map(|&corner| (corner, INFINITE_SHARPNESS)));
                Ok(mesh)
            }
        }
    }

    /// Completes a level as a file, with what keeps a meaning of the arrays of the mesh that it comes from.
    pub(super) fn stage_level(
        &self,
        mesh: &MeshFile,
        level: &Level,
        normals: Option<&[DVec3]>,
        shape_changes: bool,
        output: &Output<MeshFormat>,
        files: &mut StagedFiles,
    ) -> Result<(), Error> {
        let polygons;
        let cells = match &level.mesh {
            Connectivity::Triangles(triangles) => Cells::Triangles(triangles.triangles()),
            Connectivity::Polygons(_) => {
                polygons = level.mesh.faces();
                Cells::Polygons(&polygons[..])
            }
            Connectivity::Curves(curves) => Cells::Polylines(&curves.lines[..]),
        };
        let data = carried(mesh, level, shape_changes);
        self.report_data(mesh, &data.names(normals.is_some()));
        let content = MeshToWrite {
            normals,
            generations: level.generations.as_deref(),
            point_data: &data.of_points,
            cell_data: &data.of_cells,
            field: &data.field,
            ..self.content(&level.points, cells)
        };
        stage_mesh(&content, output, files)
    }

    /// Writes a mesh in any format; `before` is that of the file it was made of.
    pub(super) fn write_single(
        &self,
        output: &Output<MeshFormat>,
        before: &MeshFile,
        mesh: &MeshFile,
        normals: Option<&[Option<DVec3>]>,
    ) -> Result<(), Error> {
        let mut names = mesh.data_names();
        names.extend(normals.map(|_| "Normals".to_owned()));
        self.report_data(before, &names);
        let scenes = || {
            let colors = self.colors(&mesh.point_data, &mesh.face_data)?;
            let scene = Scene { colors, ..scene_of_file(mesh) };
            Ok(Scenes { before: scene_of_file(before), levels: vec![scene] })
        };
        self.write(vec![output.path().to_owned()], scenes, |files| {
            if self.format == MeshFormat::Json {
                return output.stage(files, |out| mesh_json(mesh, normals, out));
            }
            let normals: Option<Vec<DVec3>> =
                normals.map(|normals| normals.iter().map(|normal| normal.unwrap_or_default()).collect());
            let triangles = mesh.triangles();
            let cells = match &triangles {
                Ok(triangles) => Cells::Triangles(triangles),
                Err(_) => Cells::Polygons(&mesh.faces),
            };
            let content = MeshToWrite {
                normals: normals.as_deref(),
                point_data: &mesh.point_data,
                cell_data: &mesh.face_data,
                field: &mesh.field,
                ..self.content(&mesh.points, cells)
            };
            stage_mesh(&content, output, files)
        })
    }

    /// What a level of a file looks like.
    pub(super) fn scene_of_level(
        &self,
        mesh: &MeshFile,
        level: &Level,
        shape_changes: bool,
    ) -> Result<Scene, Error> {
        let CarriedData { mut of_points, of_cells, .. } = carried(mesh, level, shape_changes);
        of_points.extend(level.generation_array());
        Ok(Scene { colors: self.colors(&of_points, &of_cells)?, ..scene_of_level(level) })
    }

    /// What colours a picture, of the arrays of what is shown.
    pub(super) fn colors(
        &self,
        of_points: &[DataArray],
        of_cells: &[DataArray],
    ) -> Result<Option<SceneColors>, Error> {
        let Some(name) = self.files.shown.color_by() else { return Ok(None) };
        let find = |arrays: &[DataArray]| arrays.iter().find(|array| array.name == name)?.scalars();
        let numbers = find(of_cells).map(SceneNumbers::OfCells);
        let numbers = numbers.or_else(|| find(of_points).map(SceneNumbers::OfPoints));
        match numbers {
            Some(numbers) => Ok(Some(SceneColors { name: name.to_owned(), numbers })),
            None => {
                let with_one = of_points.iter().chain(of_cells).filter(|array| array.components == 1);
                let known = with_one.map(|array| array.name.clone()).collect();
                Err(self.located(MeshFileProblem::NoArray { name: name.to_owned(), known }))
            }
        }
    }

    /// Says once which arrays of a file are in what was made of it, and which are not, and why.
    fn report_data(&self, mesh: &MeshFile, written: &[String]) {
        let holds_arrays = matches!(self.format, MeshFormat::Vtk(_));
        let names = mesh.data_names().into_iter().chain(mesh.left_behind.iter().cloned());
        let (kept, dropped): (Vec<String>, Vec<String>) =
            names.partition(|name| holds_arrays && written.contains(name));
        let mut lines = Vec::new();
        if !kept.is_empty() {
            lines.push(format!("kept        {}", kept.join(", ")));
        }
        let mut by_reason: BTreeMap<&str, Vec<String>> = BTreeMap::new();
        for name in dropped {
            let why = if holds_arrays { mesh.why_dropped(&name) } else { "the format holds no arrays" };
            by_reason.entry(why).or_default().push(name);
        }
        lines.extend(
            by_reason.into_iter().map(|(why, names)| format!("dropped     {}: {why}", names.join(", "))),
        );
        for line in lines {
            if !self.report.borrow().contains(&line) {
                self.report(format_args!("{line}"));
            }
        }
    }

    pub(super) fn content<'a>(&'a self, points: &'a [DVec3], cells: Cells<'a>) -> MeshToWrite<'a> {
        let encoding = self.files.vtk.vtk_encoding;
        MeshToWrite { encoding, ..MeshToWrite::new(points, cells, &self.command_line) }
    }
}

/// What keeps a meaning of a file's arrays on a level.
fn carried(mesh: &MeshFile, level: &Level, shape_changes: bool) -> CarriedData {
    let arrays = match &level.mesh {
        Connectivity::Triangles(_) | Connectivity::Polygons(_) => &mesh.face_data,
        Connectivity::Curves(_) => &mesh.line_data,
    };
    CarriedData::new(mesh, level, arrays, shape_changes)
}

/// The faces of a file, or its polylines.
pub(super) fn scene_of_file(mesh: &MeshFile) -> Scene {
    let lines = if mesh.faces.is_empty() { mesh.lines.clone() } else { Vec::new() };
    Scene { points: mesh.points.clone(), faces: mesh.faces.clone(), lines, ..Scene::default() }
}

/// What a level of subdivision looks like.
pub(super) fn scene_of_level(level: &Level) -> Scene {
    let cells = level.mesh.faces();
    let is_curve = matches!(level.mesh, Connectivity::Curves(_));
    let (faces, lines) = if is_curve { (Vec::new(), cells) } else { (cells, Vec::new()) };
    Scene { points: level.points.clone(), faces, lines, ..Scene::default() }
}
