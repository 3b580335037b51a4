//! VTK's formats of one data set: every boundary and every point once.

use super::format::{Content, Extra, Format, HEAD, Writer};
use super::grains::write_vtk_grain;
use super::volume_vtu;
use crate::vtk::VtkFormat;
use crate::{FileOptions, VolumeMeshOptions};

/// The share of their bytes that compressed networks take: coordinates hardly repeat. 200 random grains took 0.55 at level 3.
pub(super) const COMPRESSED: [u128; 2] = [11, 20];

/// The same of voxels as elements: 50 grains took 0.31 to 0.33 at 50^3 to 200^3 voxels.
const COMPRESSED_VOXELS: [u128; 2] = [5, 16];

pub(super) const VTP: Format = Format {
    extension: "vtp",
    content: Content::Boundaries,
    bytes: |size| size.encoded(size.of_network(), COMPRESSED),
    write: Writer::File(|polycrystal, out| polycrystal.write_vtk(VtkFormat::Vtp, out)),
    extra: Extra { write_grain: Some(write_vtk_grain), ..Extra::NONE },
};

pub(super) const VTU: Format = Format {
    extension: "vtu",
    content: Content::BoundariesElementsOrVoxels,
    bytes: |size| match size.voxels() {
        0 => size.encoded(size.of_network() + size.mesh.triangles, COMPRESSED),
        // A point, eight corners, their end, the type and the grain.
        voxels => size.encoded(HEAD + 65 * voxels, COMPRESSED_VOXELS),
    },
    write: Writer::File(|polycrystal, out| match polycrystal.file() {
        FileOptions { voxels: Some(_), volume: VolumeMeshOptions { volume_mesh: true, .. }, .. } => {
            volume_vtu::write_voxels(polycrystal, out)
        }
        _ if polycrystal.writes_elements() => volume_vtu::write(polycrystal, out),
        _ => polycrystal.write_vtk(VtkFormat::Vtu, out),
    }),
    // Points are numbered anew where voxels outside the domain are left out.
    extra: Extra { memory_of_voxel: 76, ..Extra::NONE },
};

pub(super) const VTK: Format = Format {
    extension: "vtk",
    content: Content::Boundaries,
    bytes: |size| size.of_network(),
    write: Writer::File(|polycrystal, out| polycrystal.write_vtk(VtkFormat::Vtk, out)),
    extra: Extra::NONE,
};
