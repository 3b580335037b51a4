//! The grain of each voxel, with what is known of it, as VTK ImageData.

use std::io::{self, Write};

use polycrystal::Side;
use rayon::prelude::*;

use super::format::{Content, Extra, Format, HEAD, Writer};
use crate::vtk::{Array, ImageData, ItemTuples, Values, VtkEncoding, write_vti};
use crate::{FileOptions, GrainAttributes, GrainPhases, LabelGrid, Polycrystal};

pub(super) const FORMAT: Format = Format {
    extension: "vti",
    content: Content::Voxels(|config| match config.file.encoding {
        VtkEncoding::Zlib => 0,
        VtkEncoding::Raw | VtkEncoding::Base64 => config.bytes_of_voxel(),
    }),
    bytes: |size| {
        let bytes = HEAD + u128::from(size.config.bytes_of_voxel()) * size.voxels();
        // Labels repeat: 200^3 voxels of 20 to 200 grains took 0.03 to 0.05 of theirs.
        size.encoded(bytes, [1, 25]).max(HEAD)
    },
    write: Writer::File(write),
    extra: Extra { programs: "DAMASK", ..Extra::NONE },
};

fn write(polycrystal: &Polycrystal, out: &mut dyn Write) -> io::Result<()> {
    let grid = polycrystal.label_grid()?;
    let FileOptions { names, encoding, .. } = polycrystal.file();
    let make = |slab: usize| {
        grid.slab(slab).into_par_iter().map(|label| names.voxel_number(label)).collect::<Vec<i32>>()
    };
    let count = usize::try_from(grid.voxel_count()).map_err(io::Error::other)?;
    let slabs = grid.slab_count();
    let GrainAttributes { phases, texture, .. } = polycrystal.grains();
    let mut tuples: Vec<ItemTuples> = phases.iter().map(GrainPhases::array).collect();
    tuples.extend(texture.iter().flat_map(|texture| texture.color_arrays(names)));
    let mut cell_arrays = vec![Array { name: names.voxel(), values: Values::blocks(count, slabs, make) }];
    let grain = |label: Side| label.grain().map(|grain| grain.index());
    let items = |slab: usize| grid.slab(slab).into_par_iter().map(grain).collect::<Vec<_>>();
    cell_arrays.extend(tuples.iter().map(|tuples| tuples.of_blocks(count, slabs, items)));
    let LabelGrid { size, origin, spacing, .. } = grid;
    let mut field = polycrystal.field();
    field.push(polycrystal.seed_ids());
    field.extend(polycrystal.grain_fields());
    write_vti(&ImageData { size, origin, spacing, cell_arrays, field }, encoding, out)
}
