//! Voxels as hexahedra, in the plane as squares.

use std::io::{self, Write};

use glam::DVec3;
use voronoi::Dimension;

use super::super::label_grid::LabelGrid;
use super::{number, write_numbers, write_sections};
use crate::{GrainAttributes, Polycrystal};

/// Writes nodes, elements, and sets of them. Voxels outside the domain, and nodes that no voxel has, are left out: numbers are as of the whole grid, from 1.
pub(super) fn write(grid: &LabelGrid<'_>, polycrystal: &Polycrystal, out: &mut dyn Write) -> io::Result<()> {
    let grains: Vec<Option<u32>> =
        grid.labels().into_iter().map(|label| label.grain().map(|grain| grain.0)).collect();
    let hexahedra = Hexahedra { grid, dimension: polycrystal.dimension(), grains };
    hexahedra.write_nodes(out)?;
    hexahedra.write_elements(out)?;
    hexahedra.write_grains(polycrystal.grains(), out)
}

struct Hexahedra<'a> {
    grid: &'a LabelGrid<'a>,
    dimension: Dimension,
    /// Of each voxel; nothing outside the domain.
    grains: Vec<Option<u32>>,
}

impl Hexahedra<'_> {
    fn is_plane(&self) -> bool {
        self.dimension == Dimension::Two
    }

    /// Number of nodes along each axis.
    fn node_counts(&self) -> [usize; 3] {
        let [x, y, z] = self.grid.size;
        [x + 1, y + 1, if self.is_plane() { 1 } else { z + 1 }]
    }

    /// The nodes of a voxel, in the order of Abaqus: counter-clockwise seen from above, the lower ones first.
    fn nodes_of(&self, voxel: usize) -> Vec<usize> {
        let [nx, ny, _] = self.grid.size;
        let [i, j, k] = [voxel % nx, voxel / nx % ny, voxel / (nx * ny)];
        let [x, y, _] = self.node_counts();
        let corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
        let layers = if self.is_plane() { 0..=0 } else { 0..=1 };
        let node = |k: usize, [di, dj]: [usize; 2]| i + di + x * (j + dj + y * k);
        layers.flat_map(|dk| corners.map(|corner| node(k + dk, corner))).collect()
    }

    fn write_nodes(&self, out: &mut dyn Write) -> io::Result<()> {
        let [x, y, z] = self.node_counts();
        let mut is_used = vec![false; x * y * z];
        let inside = (0..self.grains.len()).filter(|voxel| self.grains[*voxel].is_some());
        inside.flat_map(|voxel| self.nodes_of(voxel)).for_each(|node| is_used[node] = true);
        let used = || (0..is_used.len()).filter(|node| is_used[*node]);
        let place = |node: usize| [node % x, node / x % y, node / (x * y)];
        writeln!(out, "*NODE, NSET=NODES")?;
        for node in used() {
            let steps = DVec3::from_array(place(node).map(|step| step as f64));
            let DVec3 { x, y, z } = self.grid.origin + steps * self.grid.spacing;
            let z = if self.is_plane() { 0.0 } else { z };
            writeln!(out, "{}, {}, {}, {}", node + 1, number(x), number(y), number(z))?;
        }
        for (axis, name) in ["X", "Y", "Z"].into_iter().take(self.dimension.axes().into()).enumerate() {
            for (end, step) in [(0, 0), (1, self.grid.size[axis])] {
                writeln!(out, "*NSET, NSET={name}{end}")?;
                write_numbers(used().filter(|node| place(*node)[axis] == step), out)?;
            }
        }
        Ok(())
    }

    fn write_elements(&self, out: &mut dyn Write) -> io::Result<()> {
        let kind = match self.dimension {
            Dimension::Two => "CPS4",
            Dimension::Three => "C3D8",
        };
        writeln!(out, "*ELEMENT, TYPE={kind}, ELSET=ELEMENTS")?;
        for voxel in (0..self.grains.len()).filter(|voxel| self.grains[*voxel].is_some()) {
            write!(out, "{}", voxel + 1)?;
            self.nodes_of(voxel).into_iter().try_for_each(|node| write!(out, ", {}", node + 1))?;
            writeln!(out)?;
        }
        Ok(())
    }

    fn write_grains(&self, attributes: &GrainAttributes, out: &mut dyn Write) -> io::Result<()> {
        let mut voxels: Vec<Vec<usize>> = Vec::new();
        for (voxel, grain) in self.grains.iter().enumerate() {
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
}
