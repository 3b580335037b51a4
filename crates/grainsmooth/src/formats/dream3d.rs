//! DREAM.3D's file: the grain of each voxel, with phases and mean orientations, for DREAM.3D 6 and DREAM3D-NX, which imports it.
//!
//! <https://github.com/BlueQuartzSoftware/DREAM3D/blob/develop/Documentation/ReferenceManual/3_SupportedFileFormats/Native_DREAM3D_File_Format.md>, and files that DREAM.3D 6
//! wrote. Features count from 1; 0 is none. Angles are radians.

use std::io::{self, Write};

use hdf5_pure::{AttrValue, DatasetBuilder, FileBuilder, GroupBuilder};

use super::format::{Content, Extra, Format, HEAD, Writer};
use crate::Polycrystal;
use crate::maps::hdf5::laue_group_number;

pub(super) const FORMAT: Format = Format {
    extension: "dream3d",
    content: Content::Voxels(|_| BYTES),
    bytes: |size| HEAD + u128::from(BYTES) * size.voxels(),
    write: Writer::File(write),
    // HDF5 files are complete in memory before they are written.
    extra: Extra { programs: "DREAM.3D", memory_of_voxel: 40, ..Extra::NONE },
};

/// Of a voxel: its feature, its phase and three angles.
const BYTES: u32 = 20;

/// The version of the layout.
const FILE_VERSION: &str = "7.0";

/// DREAM.3D's numbers for what the rows of a matrix of attributes are: voxels, features, phases.
const CELLS: u32 = 3;
const FEATURES: u32 = 7;
const PHASES: u32 = 11;

fn write(polycrystal: &Polycrystal, out: &mut dyn Write) -> io::Result<()> {
    let grid = polycrystal.label_grid()?;
    let [nx, ny, nz] = grid.size.map(|count| count as u64);
    let features: Vec<i32> = grid
        .labels()
        .into_iter()
        .map(|label| label.grain().map_or(0, |grain| grain.0.cast_signed() + 1))
        .collect();
    let grains = polycrystal.grains();
    // Feature 0 is none.
    let phase = |phase: usize| i32::try_from(phase + 1).map_err(io::Error::other);
    let phases = std::iter::once(Ok(0)).chain(grains.phase_of().into_iter().map(phase));
    let phases: Vec<i32> = phases.collect::<io::Result<_>>()?;
    let angles: Option<Vec<[f32; 3]>> = polycrystal.orientations().ok().map(|orientations| {
        let radians = orientations.iter().map(|orientation| {
            #[expect(clippy::cast_possible_truncation, reason = "DREAM.3D has angles in single precision")]
            orientation.euler_degrees().map(|angle| angle.to_radians() as f32)
        });
        std::iter::once([0.0; 3]).chain(radians).collect()
    });
    let of_cells = |feature: &i32| usize::try_from(*feature).unwrap_or_default();

    let mut file = FileBuilder::new();
    file.set_attr("FileVersion", ascii(FILE_VERSION));
    file.set_attr("DREAM3D Version", ascii(concat!("grainsmooth ", env!("CARGO_PKG_VERSION"))));
    file.set_attr("Config", AttrValue::String(polycrystal.provenance().text()));
    let mut containers = file.create_group("DataContainers");
    let mut container = containers.create_group("ImageDataContainer");

    let mut geometry = container.create_group("_SIMPL_GEOMETRY");
    geometry.set_attr("GeometryName", ascii("ImageGeometry"));
    geometry.set_attr("GeometryTypeName", ascii("ImageGeometry"));
    geometry.set_attr("GeometryType", AttrValue::U32Array(vec![0]));
    geometry.set_attr("SpatialDimensionality", AttrValue::U32Array(vec![3]));
    geometry.set_attr("UnitDimensionality", AttrValue::U32Array(vec![3]));
    geometry.create_dataset("DIMENSIONS").with_i64_data(&[nx, ny, nz].map(u64::cast_signed));
    geometry.create_dataset("ORIGIN").with_f32_data(&grid.origin.as_vec3().to_array());
    geometry.create_dataset("SPACING").with_f32_data(&grid.spacing.as_vec3().to_array());
    container.add_group(geometry.finish());

    let cells = Matrix { rows: vec![nx, ny, nz], kind: CELLS };
    let mut group = cells.group(&mut container, "CellData");
    let of_cell: Vec<i32> = features.iter().map(|feature| phases[of_cells(feature)]).collect();
    cells.describe(group.create_dataset("Phases").with_i32_data(&of_cell), 1, "DataArray<int32_t>");
    if let Some(angles) = &angles {
        let of_cell: Vec<[f32; 3]> = features.iter().map(|feature| angles[of_cells(feature)]).collect();
        let array = group.create_dataset("EulerAngles").with_f32_data(of_cell.as_flattened());
        cells.describe(array, 3, "DataArray<float>");
    }
    cells.describe(group.create_dataset("FeatureIds").with_i32_data(&features), 1, "DataArray<int32_t>");
    container.add_group(group.finish());

    let of_features = Matrix { rows: vec![phases.len() as u64], kind: FEATURES };
    let mut group = of_features.group(&mut container, "CellFeatureData");
    of_features.describe(group.create_dataset("Phases").with_i32_data(&phases), 1, "DataArray<int32_t>");
    let ids: Vec<i32> = std::iter::once(-1).chain(grains.ids.iter().map(|id| id.cast_signed())).collect();
    of_features.describe(group.create_dataset("SeedId").with_i32_data(&ids), 1, "DataArray<int32_t>");
    if let Some(angles) = &angles {
        let array = group.create_dataset("AvgEulerAngles").with_f32_data(angles.as_flattened());
        of_features.describe(array, 3, "DataArray<float>");
    }
    container.add_group(group.finish());

    let named = grains.named_symmetries();
    let of_phases = Matrix { rows: vec![named.len() as u64 + 1], kind: PHASES };
    let mut group = of_phases.group(&mut container, "CellEnsembleData");
    let structures = named.iter().map(|(_, symmetry)| laue_group_number(Some(*symmetry)));
    let structures: Vec<u32> = std::iter::once(laue_group_number(None)).chain(structures).collect();
    let array = group.create_dataset("CrystalStructures").with_u32_data(&structures);
    of_phases.describe(array, 1, "DataArray<uint32_t>");
    let names: Vec<&str> =
        std::iter::once("Invalid Phase").chain(named.iter().map(|(name, _)| name.as_str())).collect();
    let array = group.create_dataset("MaterialName").with_vlen_strings(&names);
    of_phases.attributes(array, 1, "StringDataArray");
    container.add_group(group.finish());

    containers.add_group(container.finish());
    file.add_group(containers.finish());
    for name in ["DataContainerBundles", "Montages", "Pipeline"] {
        let group = file.create_group(name).finish();
        file.add_group(group);
    }
    file.finish_to(out).map_err(io::Error::other)
}

/// A matrix of attributes: arrays with a row for each voxel, feature or phase.
struct Matrix {
    /// How many there are along each axis, x first.
    rows: Vec<u64>,
    kind: u32,
}

impl Matrix {
    fn group(&self, container: &mut GroupBuilder, name: &str) -> GroupBuilder {
        let mut group = container.create_group(name);
        group.set_attr("AttributeMatrixType", AttrValue::U32Array(vec![self.kind]));
        group.set_attr("TupleDimensions", AttrValue::U64Array(self.rows.clone()));
        group
    }

    /// Gives an array its shape, z first and the components last, and what DREAM.3D wants to know.
    fn describe(&self, array: &mut DatasetBuilder, components: u64, kind: &str) {
        let shape: Vec<u64> = self.rows.iter().rev().copied().chain([components]).collect();
        self.attributes(array.with_shape(&shape), components, kind);
    }

    fn attributes(&self, array: &mut DatasetBuilder, components: u64, kind: &str) {
        let axes = ["x", "y", "z"].iter().zip(&self.rows).map(|(axis, count)| format!("{axis}={count}"));
        array.set_attr("ComponentDimensions", AttrValue::U64Array(vec![components]));
        array.set_attr("DataArrayVersion", AttrValue::I32Array(vec![2]));
        array.set_attr("ObjectType", ascii(kind));
        array.set_attr("Tuple Axis Dimensions", ascii(&axes.collect::<Vec<_>>().join(",")));
        array.set_attr("TupleDimensions", AttrValue::U64Array(self.rows.clone()));
    }
}

fn ascii(text: &str) -> AttrValue {
    AttrValue::AsciiString(text.to_owned())
}
