//! Any bytes under any of the extensions that `grainsmooth mesh` reads: an error or a mesh, and never a panic.
#![no_main]

use std::io::Write;

use grainsmooth::mesh::file::{READER_THREAD, read_mesh};
use grainsmooth::read_bezier;
use libfuzzer_sys::fuzz_target;

const EXTENSIONS: [&str; 8] = [".obj", ".off", ".ply", ".stl", ".vtk", ".vtp", ".vtu", ".json"];

fuzz_target!(
    init: {
        // What vtkio cannot digest ends its thread and becomes an error.
        let hook = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if std::thread::current().name() != Some(READER_THREAD) {
                hook(info);
            }
        }));
    },
    |data: &[u8]| {
        // The first byte names the format.
        let Some((&format, bytes)) = data.split_first() else { return };
        let extension = EXTENSIONS[usize::from(format) % EXTENSIONS.len()];
        let mut file = tempfile::Builder::new().suffix(extension).tempfile().expect("a temporary file opens");
        file.write_all(bytes).expect("a temporary file takes bytes");
        if let Ok(mesh) = read_mesh(file.path()) {
            assert!(mesh.points.iter().all(|point| point.is_finite()));
            assert!(mesh.faces.iter().flatten().all(|&v| (v as usize) < mesh.points.len()));
            let _ = mesh.triangle_mesh();
            let _ = mesh.polygon_mesh();
        }
        if extension == ".json" {
            let _ = read_bezier(file.path());
        }
    }
);
