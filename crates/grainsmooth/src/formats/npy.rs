//! NumPy's array file, version 1.0: the labels as `<i4` of shape (nx, ny, nz), x fastest.
//!
//! <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>

use std::io::{self, Write};

use rayon::prelude::*;

use super::format::{Content, Extra, Format, HEAD, Writer};
use super::label_grid::LabelGrid;
use crate::names::Names;

pub(super) const FORMAT: Format = Format {
    extension: "npy",
    content: Content::Voxels(|_| 4),
    bytes: |size| HEAD + 4 * size.voxels(),
    write: Writer::File(|polycrystal, out| {
        write(&polycrystal.label_grid()?, polycrystal.file().names, out)?;
        polycrystal.write_settings_behind(out)
    }),
    extra: Extra::NONE,
};

/// Header and magic together must be a multiple of this.
const ALIGNMENT: usize = 64;

/// Writes the labels.
fn write(grid: &LabelGrid<'_>, names: Names, out: &mut dyn Write) -> io::Result<()> {
    let [nx, ny, nz] = grid.size;
    let mut header = format!("{{'descr': '<i4', 'fortran_order': True, 'shape': ({nx}, {ny}, {nz}), }}");
    let magic = b"\x93NUMPY\x01\x00";
    // Two bytes for the length, one for the line's end.
    let length = (magic.len() + 2 + header.len() + 1).next_multiple_of(ALIGNMENT);
    while header.len() < length - magic.len() - 2 - 1 {
        header.push(' ');
    }
    header.push('\n');
    out.write_all(magic)?;
    out.write_all(&u16::try_from(header.len()).map_err(io::Error::other)?.to_le_bytes())?;
    out.write_all(header.as_bytes())?;
    (0..grid.slab_count()).try_for_each(|slab| {
        let numbers: Vec<[u8; 4]> =
            grid.slab(slab).into_par_iter().map(|label| names.voxel_number(label).to_le_bytes()).collect();
        out.write_all(numbers.as_flattened())
    })
}
