//! VTK's formats of one data set: every boundary and every point once.

use super::format::{Content, Extra, Format, Writer};
use super::grains::write_vtk_grain;
use super::volume_vtu;
use crate::vtk::VtkFormat;

/// The share of their bytes that compressed networks take: coordinates hardly repeat. 200 random grains took 0.55 at level 3.
pub(super) const COMPRESSED: [u128; 2] = [11, 20];

pub(super) const VTP: Format = Format {
    extension: "vtp",
    content: Content::Boundaries,
    bytes: |size| size.encoded(size.of_network(), COMPRESSED),
    write: Writer::File(|polycrystal, out| polycrystal.write_vtk(VtkFormat::Vtp, out)),
    extra: Extra { write_grain: Some(write_vtk_grain), ..Extra::NONE },
};

pub(super) const VTU: Format = Format {
    extension: "vtu",
    content: Content::BoundariesOrTetrahedra,
    bytes: |size| size.encoded(size.of_network() + size.mesh.triangles, COMPRESSED),
    write: Writer::File(|polycrystal, out| match polycrystal.tetrahedra_instead_of_boundaries() {
        Some(mesh) => volume_vtu::write(polycrystal, mesh, out),
        None => polycrystal.write_vtk(VtkFormat::Vtu, out),
    }),
    extra: Extra::NONE,
};

pub(super) const VTK: Format = Format {
    extension: "vtk",
    content: Content::Boundaries,
    bytes: |size| size.of_network(),
    write: Writer::File(|polycrystal, out| polycrystal.write_vtk(VtkFormat::Vtk, out)),
    extra: Extra::NONE,
};
