//! Arrays of points, cells and grains on their way through the command.

use std::process::Command;

use grainsmooth::mesh::file::{MeshFile, read_mesh};
use grainsmooth::vtk::{DataArray, DataNumbers, FieldValue};

use crate::programs::run;
use crate::shapes::CUBE_OBJ;
use crate::workplace::Workplace;

fn read(workplace: &Workplace, name: &str) -> MeshFile {
    read_mesh(&workplace.path(name)).unwrap()
}

fn named<'a>(arrays: &'a [DataArray], name: &str) -> &'a DataArray {
    arrays.iter().find(|array| array.name == name).unwrap_or_else(|| panic!("no {name}"))
}

fn int32(arrays: &[DataArray], name: &str) -> Vec<i32> {
    match &named(arrays, name).numbers {
        DataNumbers::Int32(numbers) => numbers.clone(),
        other => panic!("{name} is {other:?}"),
    }
}

/// Labels go to the children, edges between other labels are sharp without being named, and the checker of networks finds
/// grains that still fill the box, through all formats.
#[test]
fn smoothed_grains_are_grains() {
    let workplace = Workplace::new();
    for extension in ["vtp", "vtu", "vtk"] {
        workplace.run(&format!("--seeds 12 -n 0 --texture random -o in.{extension}"));
        let said = workplace.run(&format!("mesh loop in.{extension} -n 2 -o out.{extension}"));
        for line in [
            "kept        BoundaryId, Config, CrystalSymmetries, Disorientation, DisorientationAxis, EulerAngles, FaceLabels, \
             Generation, Quaternion, RandomSeed, SeedId\n",
            "dropped     Volumes: the shape changes\n",
            "dropped     NodeTypes, NumberOfGrains: whole numbers have no means at new points\n",
        ] {
            assert!(said.contains(line), "{line} in {said}");
        }
        workplace.command(&format!("check out.{extension}")).assert().success();
        let (coarse, fine) =
            (read(&workplace, &format!("in.{extension}")), read(&workplace, &format!("out.{extension}")));
        // The k-th child of triangle t is 3 t + k, its middle one comes after all corners.
        let labels = int32(&coarse.face_data, "FaceLabels");
        let children = int32(&fine.face_data, "FaceLabels");
        let count = coarse.faces.len();
        assert_eq!(children.len(), 2 * 16 * count);
        for (child, pair) in children.as_chunks::<2>().0.iter().enumerate() {
            let up =
                |child: usize, count: usize| if child < 3 * count { child / 3 } else { child - 3 * count };
            let parent = up(up(child, 4 * count), count);
            assert_eq!(pair, &labels[2 * parent..2 * parent + 2], "{extension} {child}");
        }
        let born = named(&fine.point_data, "Generation");
        let DataNumbers::Int8(born) = &born.numbers else { panic!() };
        assert_eq!(born.iter().max(), Some(&2));
        assert!(born[..coarse.points.len()].iter().all(|level| *level == 0));
        // What is said of the grains stays.
        let angles = |mesh: &MeshFile| {
            mesh.field.iter().find(|entry| entry.name == "EulerAngles").map(|entry| entry.value.clone())
        };
        assert!(
            matches!(angles(&fine), Some(FieldValue::Data(array)) if array.len() == 12 && array.components == 3)
        );
        assert_eq!(angles(&fine), angles(&coarse));
    }
}

#[test]
fn boundaries_in_the_plane_are_curves_with_their_labels() {
    let workplace = Workplace::new();
    workplace.run("--dim 2 --seeds 15 -n 0 --relax 0 -o in.vtp");
    workplace.run("mesh b-spline in.vtp -n 2 -o out.vtp");
    workplace.command("check out.vtp").assert().success();
}

#[test]
fn generation_survives_normals_and_goes_on() {
    let workplace = Workplace::new();
    workplace.put("cube.obj", CUBE_OBJ);
    workplace.run("mesh triangulate cube.obj -o cube.vtp");
    workplace.run("mesh loop cube.vtp -n 1 -o one.vtp");
    workplace.run("mesh normals one.vtp -o normals.vtu");
    let generations = |name: &str| {
        let mesh = read(&workplace, name);
        match &named(&mesh.point_data, "Generation").numbers {
            DataNumbers::Int8(levels) => levels.clone(),
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(generations("normals.vtu"), generations("one.vtp"));
    let said = workplace.run("mesh loop normals.vtu -n 1 -o two.vtk");
    assert!(said.contains("dropped     Normals: they change"), "{said}");
    let levels = generations("two.vtk");
    workplace.run("mesh loop cube.vtp -n 2 -o at_once.vtk");
    assert_eq!(levels, generations("at_once.vtk"));
    let said = workplace.run("mesh normals two.vtk -o two.obj");
    assert!(said.contains("dropped     Generation: the format holds no arrays"), "{said}");
}

/// A file of VTK itself, with arrays of every kind: floating point numbers are means, others stay where they can.
#[test]
fn arrays_of_other_programs() {
    let workplace = Workplace::new();
    workplace.put("cube.obj", CUBE_OBJ);
    workplace.run("mesh triangulate cube.obj -o cube.vtp");
    let write = "
import numpy, pyvista
cube = pyvista.read('cube.vtp')
cube.field_data.clear()
cube.point_data['temperature'] = cube.points[:, 0] + 2 * cube.points[:, 1]
cube.point_data['single'] = cube.points.astype(numpy.float32)
cube.point_data['id'] = numpy.arange(cube.n_points, dtype=numpy.int64)
cube.cell_data['side'] = numpy.arange(12, dtype=numpy.int32) // 2
cube.field_data['time'] = [0.5]
cube.save('in.vtk')
cube.point_data['name'] = ['a'] * cube.n_points
cube.save('in.vtp'); cube.cast_to_unstructured_grid().save('in.vtu')
";
    let python = |script: &str| {
        let mut python = Command::new("python3");
        python.args(["-c", script]).current_dir(workplace.path("."));
        let output = run("arrays_of_other_programs", &mut python)?;
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        Some(())
    };
    let Some(()) = python(write) else { return };
    for extension in ["vtp", "vtu", "vtk"] {
        let said = workplace.run(&format!("mesh midpoint in.{extension} -o out.{extension}"));
        assert!(said.contains("kept        side, single, temperature\n"), "{said}");
        assert!(said.contains("dropped     id: whole numbers have no means at new points\n"), "{said}");
        assert!(said.contains("time: not numbers, or not a tuple for each\n"), "{said}");
        let said =
            workplace.run(&format!("mesh edit in.{extension} flip=1-3 split=flat -o edited.{extension}"));
        assert!(said.contains("kept        side, single, temperature\n"), "{said}");
        workplace.run(&format!("mesh normals in.{extension} -o normals.{extension}"));
        let read_back = "
import pyvista, sys
for name, count in [('out', 48), ('edited', None)]:
    mesh = pyvista.read(f'{name}.EXT')
    if not isinstance(mesh, pyvista.PolyData): mesh = mesh.extract_surface()
    t = mesh.points[:, 0] + 2 * mesh.points[:, 1]
    assert abs(mesh.point_data['temperature'] - t).max() < 1e-15
    assert abs(mesh.point_data['single'] - mesh.points).max() < 1e-15
    # Triangles of one side of the cube lie in one plane.
    for side in range(6):
        corners = mesh.extract_cells(mesh.cell_data['side'] == side).points
        assert min(abs(corners - corners[0]).max(axis=0)) < 1e-15, side
    assert count is None or mesh.n_cells == count
mesh = pyvista.read('normals.EXT')
assert mesh.point_data.active_normals_name == 'Normals', mesh.point_data
assert abs((mesh.point_data['Normals'] ** 2).sum(axis=1) - 1).max() < 1e-15
assert list(mesh.point_data['id']) == list(range(8))
";
        python(&read_back.replace("EXT", extension));
    }
}

#[test]
fn turned_faces_exchange_their_sides() {
    let workplace = Workplace::new();
    workplace.run("--seeds 4 -n 0 -o in.vtp");
    workplace.run("mesh edit in.vtp reverse -o out.vtp");
    let (before, after) = (read(&workplace, "in.vtp"), read(&workplace, "out.vtp"));
    for (ours, theirs) in int32(&after.face_data, "FaceLabels")
        .as_chunks::<2>()
        .0
        .iter()
        .zip(int32(&before.face_data, "FaceLabels").as_chunks::<2>().0)
    {
        assert_eq!(*ours, [theirs[1], theirs[0]]);
    }
    workplace.run("mesh edit out.vtp reverse -o again.vtp");
    assert_eq!(read(&workplace, "again.vtp").face_data, before.face_data);
    workplace.command("check again.vtp").assert().success();
}
