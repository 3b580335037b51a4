//! Input files of Abaqus and CalculiX: each voxel a hexahedron, in the plane a square.
//!
//! Abaqus Analysis User's Guide, "Input syntax rules", "Solid (continuum) elements"; CalculiX CrunchiX User's Manual.

use std::io::{self, Write};

use glam::DVec3;
use voronoi::Dimension;

use super::format::{Content, Format, HEAD, TEXT_CORNERS, TEXT_POINT, Writer};
use super::label_grid::LabelGrid;
use crate::{Config, Tessellated};

/// A node and an element for each voxel, and its number in a set.
pub(super) const FORMAT: Format = Format {
    extension: "inp",
    programs: "Abaqus, CalculiX",
    content: Content::Voxels(|_| 0),
    dimension: None,
    beside: None,
    bytes: |size| HEAD + (TEXT_POINT + 3 * TEXT_CORNERS) * size.voxels(),
    write: Writer::File(|polycrystal, out| {
        write(&polycrystal.label_grid()?, &polycrystal.cells, &polycrystal.config, out)
    }),
    write_grain: None,
};

/// Most numbers in a line of a set.
const OF_LINE: usize = 16;

/// The material of all grains where there are no phases.
const ONE_MATERIAL: &str = "GRAINS";

/// Writes nodes, elements, and sets of them: `GRAIN_0` and so on, `PHASE_` with a name, and the nodes of the domain's sides, `X0` to `Z1`. With
/// orientations each grain has its own, by the crystal's first two axes. Materials, named as the phases are, and steps are for the user to
/// say. Voxels outside the domain, and nodes that no voxel has, are left out: numbers are as of the whole grid, from 1.
fn write(grid: &LabelGrid<'_>, cells: &Tessellated, config: &Config, out: &mut dyn Write) -> io::Result<()> {
    config.write_comments("** ", out)?;
    let grains: Vec<Option<u32>> =
        grid.labels().into_iter().map(|label| label.grain().map(|grain| grain.0)).collect();
    let hexahedra = Hexahedra { grid, dimension: config.dimension, grains };
    hexahedra.write_nodes(out)?;
    hexahedra.write_elements(out)?;
    hexahedra.write_grains(cells, config, out)
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
            writeln!(out, "{}, {x:?}, {y:?}, {:?}", node + 1, if self.is_plane() { 0.0 } else { z })?;
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

    fn write_grains(&self, cells: &Tessellated, config: &Config, out: &mut dyn Write) -> io::Result<()> {
        let mut voxels: Vec<Vec<usize>> = Vec::new();
        for (voxel, grain) in self.grains.iter().enumerate() {
            let Some(grain) = grain else { continue };
            let grain = *grain as usize;
            voxels.resize_with(voxels.len().max(grain + 1), Vec::new);
            voxels[grain].push(voxel);
        }
        let phase_of = cells.phase_of();
        let names: Vec<String> = match &cells.phases {
            Some(_) => cells.named_symmetries(config).into_iter().map(|(name, _)| name).collect(),
            None => vec![ONE_MATERIAL.to_owned()],
        };
        // A grain may be smaller than a voxel.
        let grains = || (0..voxels.len()).filter(|grain| !voxels[*grain].is_empty());
        for grain in grains() {
            writeln!(out, "*ELSET, ELSET=GRAIN_{grain}")?;
            write_numbers(voxels[grain].iter().copied(), out)?;
        }
        for (phase, name) in names.iter().enumerate().filter(|_| cells.phases.is_some()) {
            let members: Vec<usize> = grains().filter(|grain| phase_of[*grain] == phase).collect();
            if !members.is_empty() {
                writeln!(out, "*ELSET, ELSET=PHASE_{name}")?;
                members.iter().try_for_each(|grain| writeln!(out, "GRAIN_{grain},"))?;
            }
        }
        for grain in grains() {
            let name = &names[phase_of[grain]];
            let mut orientation = String::new();
            if let Some(texture) = &cells.texture {
                let [first, second] =
                    [DVec3::X, DVec3::Y].map(|axis| texture.orientations()[grain].to_sample(axis));
                let numbers = [first.to_array(), second.to_array()].concat();
                let numbers: Vec<String> = numbers.iter().map(|number| format!("{number:?}")).collect();
                writeln!(out, "*ORIENTATION, NAME=ORIENTATION_{grain}\n{}", numbers.join(", "))?;
                orientation = format!(", ORIENTATION=ORIENTATION_{grain}");
            }
            writeln!(out, "*SOLID SECTION, ELSET=GRAIN_{grain}, MATERIAL={name}{orientation}")?;
        }
        Ok(())
    }
}

/// Writes numbers that count from 0 as they count from 1.
fn write_numbers(numbers: impl Iterator<Item = usize>, out: &mut dyn Write) -> io::Result<()> {
    let numbers: Vec<String> = numbers.map(|number| (number + 1).to_string()).collect();
    numbers.chunks(OF_LINE).try_for_each(|line| writeln!(out, "{}", line.join(", ")))
}
