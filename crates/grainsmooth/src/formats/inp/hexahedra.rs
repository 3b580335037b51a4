//! Voxels as elements: hexahedra, in the plane squares.

use std::io::{self, Write};

use voronoi::Dimension;

use super::super::hexahedra::Hexahedra;
use super::super::label_grid::LabelGrid;
use super::elements::write_node;
use super::{write_numbers, write_sections};
use crate::names::AXES;
use crate::{GrainAttributes, PlaneState, Polycrystal};

/// Writes nodes, elements, and sets of them, numbered as of the whole grid, from 1.
pub(super) fn write(grid: &LabelGrid<'_>, polycrystal: &Polycrystal, out: &mut dyn Write) -> io::Result<()> {
    let hexahedra = Hexahedra::new(grid, polycrystal.dimension());
    write_nodes(&hexahedra, out)?;
    let kind = match (hexahedra.dimension, polycrystal.file().volume.plane_state.unwrap_or_default()) {
        (Dimension::Two, PlaneState::Stress) => "CPS4",
        (Dimension::Two, PlaneState::Strain) => "CPE4",
        (Dimension::Three, _) => "C3D8",
    };
    writeln!(out, "*ELEMENT, TYPE={kind}, ELSET=ELEMENTS")?;
    for voxel in hexahedra.voxels() {
        write!(out, "{}", voxel + 1)?;
        hexahedra.nodes_of(voxel).into_iter().try_for_each(|node| write!(out, ", {}", node + 1))?;
        writeln!(out)?;
    }
    write_grains(&hexahedra.grains, polycrystal.grains(), out)
}

fn write_nodes(hexahedra: &Hexahedra<'_>, out: &mut dyn Write) -> io::Result<()> {
    let nodes = hexahedra.nodes();
    writeln!(out, "*NODE, NSET=NODES")?;
    nodes.iter().try_for_each(|node| write_node(node + 1, hexahedra.place(*node), out))?;
    for (axis, name) in AXES.into_iter().take(hexahedra.dimension.axes().into()).enumerate() {
        for (end, step) in [(0, 0), (1, hexahedra.voxels_along(axis))] {
            writeln!(out, "*NSET, NSET={}{end}", name.to_uppercase())?;
            let on_side = nodes.iter().copied().filter(|node| hexahedra.steps(*node)[axis] == step);
            write_numbers(on_side, out)?;
        }
    }
    Ok(())
}

fn write_grains(
    of_voxels: &[Option<u32>],
    attributes: &GrainAttributes,
    out: &mut dyn Write,
) -> io::Result<()> {
    let mut voxels: Vec<Vec<usize>> = Vec::new();
    for (voxel, grain) in of_voxels.iter().enumerate() {
        let Some(grain) = grain else { continue };
        let grain = *grain as usize;
        voxels.resize_with(voxels.len().max(grain + 1), Vec::new);
        voxels[grain].push(voxel);
    }
    // A grain may be smaller than a voxel.
    let grains: Vec<usize> = (0..voxels.len()).filter(|grain| !voxels[*grain].is_empty()).collect();
    for grain in &grains {
        writeln!(out, "*ELSET, ELSET=GRAIN_{grain}")?;
        write_numbers(voxels[*grain].iter().copied(), out)?;
    }
    write_sections(&grains, attributes, out)
}
