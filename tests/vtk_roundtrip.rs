//! Every format read back with vtkio: what was put in comes out, bit for bit.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use glam::DVec3;
use grainsmooth::vtk::{Array, Cells, FieldEntry, FieldValue, PolyData, Values, VtkEncoding, VtkFormat};
use grainsmooth::vtk::{field_text, inlined, write_vtk};
use vtkio::model::{Attribute, Attributes, CellType, DataSet, IOBuffer, Piece, VertexNumbers, Vtk};

/// Coordinates that lose digits in anything but 64-bit floats.
const POINTS: [DVec3; 5] = [
    DVec3::new(0.0, -0.0, 1e-8),
    DVec3::new(0.1, 1.0 / 3.0, 1e-300),
    DVec3::new(1e-8 / 3.0, -1e300, 5e-324),
    DVec3::new(std::f64::consts::PI, 2.0, 3.0),
    DVec3::new(1.0, 1.0 + f64::EPSILON, 1.0 - f64::EPSILON),
];
const TRIANGLES: [[u32; 3]; 3] = [[0, 1, 2], [2, 1, 3], [4, 0, 3]];
const LABELS: [[i32; 2]; 3] = [[0, 1], [7, i32::MAX], [2, -1]];
const BOUNDARIES: [i32; 3] = [0, 1, 70_000];
const NODE_TYPES: [i8; 5] = [2, 3, 4, 14, -1];
const COMMAND: &str = "grainsmooth --seeds 200 -o 'gräins & <more>.vtp'";

fn surface(cells: Cells<'_>) -> PolyData<'_> {
    PolyData {
        points: &POINTS,
        cells,
        point_arrays: vec![Array { name: "NodeTypes", values: Values::slice(&NODE_TYPES) }],
        cell_arrays: vec![
            Array { name: "FaceLabels", values: Values::slice(&LABELS[..cells.len()]) },
            Array { name: "BoundaryId", values: Values::slice(&BOUNDARIES[..cells.len()]) },
        ],
        field: vec![
            FieldEntry { name: "CommandLine", value: FieldValue::Text(COMMAND.to_owned()) },
            FieldEntry { name: "RandomSeed", value: FieldValue::Integer(u64::MAX - 1) },
        ],
    }
}

fn bytes(data: &PolyData<'_>, format: VtkFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_vtk(data, format, VtkEncoding::Raw, &mut bytes).unwrap();
    bytes
}

/// Arrays as name, number of components and values, whichever way the format holds them.
fn named(attributes: Vec<Attribute>) -> Vec<(String, u32, IOBuffer)> {
    let arrays = attributes.into_iter().flat_map(|attribute| match attribute {
        Attribute::DataArray(array) => vec![(array.name, array.elem.num_comp(), array.data)],
        Attribute::Field { data_array, .. } => {
            data_array.into_iter().map(|array| (array.name, array.elem, array.data)).collect()
        }
    });
    arrays.collect()
}

fn inline<P>(pieces: Vec<Piece<P>>) -> P {
    match pieces.into_iter().next() {
        Some(Piece::Inline(piece)) => *piece,
        _ => panic!("no inline piece"),
    }
}

/// The arrays of a data set, written and read.
fn attributes_of(data: &PolyData<'_>, format: VtkFormat) -> Attributes {
    let file = bytes(data, format);
    let file = match format {
        VtkFormat::Vtk => Vtk::parse_legacy_be(&file[..]).unwrap(),
        _ => Vtk::parse_xml(&inlined(&file)[..]).unwrap(),
    };
    match file.data {
        DataSet::PolyData { pieces, .. } => inline(pieces).data,
        DataSet::UnstructuredGrid { pieces, .. } => inline(pieces).data,
        _ => panic!("neither PolyData nor UnstructuredGrid"),
    }
}

/// Checks coordinates and arrays; returns each cell's kind and points.
fn check(file: Vtk) -> Vec<(CellType, Vec<u64>)> {
    let (points, cells, attributes) = match file.data {
        DataSet::PolyData { pieces, .. } => {
            let piece = inline(pieces);
            let (kind, vertices) = match (piece.polys, piece.lines) {
                (Some(polys), None) => (CellType::Triangle, polys),
                (None, Some(lines)) => (CellType::PolyLine, lines),
                _ => panic!("neither polys alone nor lines alone"),
            };
            (piece.points, split(vertices).into_iter().map(|cell| (kind, cell)).collect(), piece.data)
        }
        DataSet::UnstructuredGrid { pieces, .. } => {
            let piece = inline(pieces);
            let cells: Vec<_> = piece.cells.types.into_iter().zip(split(piece.cells.cell_verts)).collect();
            (piece.points, cells, piece.data)
        }
        _ => panic!("neither PolyData nor UnstructuredGrid"),
    };
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    let expected: Vec<f64> = POINTS.iter().flat_map(|point| point.to_array()).collect();
    assert_eq!(bits(&points.into_vec::<f64>().unwrap()), bits(&expected));

    let labels: Vec<i32> = LABELS[..cells.len()].as_flattened().to_vec();
    assert_eq!(
        named(attributes.cell),
        [
            ("FaceLabels".to_owned(), 2, IOBuffer::I32(labels)),
            ("BoundaryId".to_owned(), 1, IOBuffer::I32(BOUNDARIES[..cells.len()].to_vec())),
        ]
    );
    assert_eq!(named(attributes.point), [("NodeTypes".to_owned(), 1, IOBuffer::I8(NODE_TYPES.to_vec()))]);
    cells
}

fn split(vertices: VertexNumbers) -> Vec<Vec<u64>> {
    let (connectivity, ends) = vertices.into_xml();
    let mut start = 0;
    ends.into_iter()
        .map(|end| {
            let cell = connectivity[start..usize::try_from(end).unwrap()].to_vec();
            start += cell.len();
            cell
        })
        .collect()
}

fn read(mut file: Vec<u8>, format: VtkFormat) -> Vtk {
    if format != VtkFormat::Vtk {
        return Vtk::parse_xml(&inlined(&file)[..]).unwrap();
    }
    // vtkio does not know field data at the head of a legacy file: take them out.
    let find = |text: &[u8]| file.windows(text.len()).position(|window| window == text).unwrap();
    let field = find(b"FIELD FieldData")..find(b"POINTS");
    let mut expected = b"FIELD FieldData 2\nCommandLine 1 1 string\n\x40\0\0\x31".to_vec();
    expected.extend_from_slice(COMMAND.as_bytes());
    expected.extend_from_slice(b"\nRandomSeed 1 1 vtktypeuint64\n");
    expected.extend_from_slice(&(u64::MAX - 1).to_be_bytes());
    expected.push(b'\n');
    assert_eq!(file[field.clone()], expected);
    file.drain(field);
    Vtk::parse_legacy_be(&file[..]).unwrap()
}

#[test]
fn triangles_come_back() {
    for format in VtkFormat::ALL {
        let file = bytes(&surface(Cells::Triangles(&TRIANGLES)), format);
        let expected = TRIANGLES.map(|triangle| (CellType::Triangle, triangle.map(u64::from).to_vec()));
        assert_eq!(check(read(file, format)), expected, "{format:?}");
    }
}

/// Without a change to the bytes, which raw files need.
#[test]
fn vtkio_reads_encoded_files_as_they_are() {
    let expected = TRIANGLES.map(|triangle| (CellType::Triangle, triangle.map(u64::from).to_vec()));
    for encoding in [VtkEncoding::Base64, VtkEncoding::Zlib] {
        for format in [VtkFormat::Vtp, VtkFormat::Vtu] {
            let data = surface(Cells::Triangles(&TRIANGLES));
            let mut file = Vec::new();
            write_vtk(&data, format, encoding, &mut file).unwrap();
            assert!(file.is_ascii(), "{encoding:?}");
            assert_eq!(field_text(&file, "CommandLine").as_deref(), Some(COMMAND), "{encoding:?} {format:?}");
            assert_eq!(check(Vtk::parse_xml(&file[..]).unwrap()), expected, "{encoding:?} {format:?}");
        }
    }
}

/// Arrays of one block, of just one and of several that are compressed apart: 2^18 bytes each.
#[test]
fn long_arrays_come_back_compressed() {
    for count in [1 << 14, 1 << 15, (1 << 16) + 3] {
        let values: Vec<f64> = (0..count).map(|i| f64::from(i).sqrt()).collect();
        let points: Vec<DVec3> = values.iter().map(|value| DVec3::splat(*value)).collect();
        let array = Array { name: "Roots", values: Values::slice(&values) };
        let data = PolyData {
            points: &points,
            cells: Cells::Triangles(&TRIANGLES),
            point_arrays: vec![array],
            cell_arrays: vec![],
            field: vec![],
        };
        for (encoding, format) in [(VtkEncoding::Base64, VtkFormat::Vtp), (VtkEncoding::Zlib, VtkFormat::Vtu)]
        {
            let mut file = Vec::new();
            write_vtk(&data, format, encoding, &mut file).unwrap();
            let attributes = match Vtk::parse_xml(&file[..]).unwrap().data {
                DataSet::PolyData { pieces, .. } => inline(pieces).data,
                DataSet::UnstructuredGrid { pieces, .. } => inline(pieces).data,
                _ => panic!("neither PolyData nor UnstructuredGrid"),
            };
            assert_eq!(named(attributes.point), [("Roots".to_owned(), 1, IOBuffer::F64(values.clone()))]);
        }
    }
}

#[test]
fn polylines_come_back() {
    let polylines = [vec![0, 1], vec![4, 3, 2, 0, 1]];
    for format in VtkFormat::ALL {
        let file = bytes(&surface(Cells::Polylines(&polylines)), format);
        let expected =
            polylines.clone().map(|line| (CellType::PolyLine, line.into_iter().map(u64::from).collect()));
        assert_eq!(check(read(file, format)), expected, "{format:?}");
    }
}

#[test]
fn field_data_stand_in_the_xml_head() {
    let data = surface(Cells::Triangles(&TRIANGLES));
    for (format, head) in [
        (
            VtkFormat::Vtp,
            r#"<PolyData><FieldData><Array type="String" Name="CommandLine" NumberOfComponents="1" NumberOfTuples="1" format="appended""#,
        ),
        (
            VtkFormat::Vtu,
            r#"<UnstructuredGrid><FieldData><DataArray type="UInt8" Name="CommandLine" NumberOfComponents="1" NumberOfTuples="49" format="appended""#,
        ),
    ] {
        let file = bytes(&data, format);
        let text = String::from_utf8_lossy(&file);
        assert!(text.contains(head), "{text}");
        assert_eq!(field_text(&file, "CommandLine").as_deref(), Some(COMMAND));
        assert_eq!(field_text(&file, "Command"), None);
        for length in 0..file.len() {
            // Whatever is missing, nothing panics and nothing is made up.
            let found = field_text(&file[..length], "CommandLine");
            assert!(found.is_none_or(|text| text == COMMAND), "{length} bytes");
        }
    }
}

#[test]
fn computed_values_and_tuples_come_back() {
    let label = |cell: usize| LABELS[cell];
    let id = |cell: usize| BOUNDARIES[cell];
    let size = |cell: usize| POINTS[cell].x;
    let kind = |point: usize| NODE_TYPES[point];
    let three = [1, 2, 3, 4, 5, 6, -1, -2, i32::MIN];
    let data = PolyData {
        points: &POINTS,
        cells: Cells::Triangles(&TRIANGLES),
        point_arrays: vec![Array { name: "NodeTypes", values: Values::each(5, kind) }],
        cell_arrays: vec![
            Array { name: "FaceLabels", values: Values::each(3, label) },
            Array { name: "BoundaryId", values: Values::each(3, id) },
            Array { name: "Size", values: Values::each(3, size) },
            Array { name: "Sides", values: Values::tuples(3, &three) },
        ],
        field: vec![],
    };
    for format in VtkFormat::ALL {
        let attributes = attributes_of(&data, format);
        assert_eq!(named(attributes.point), [("NodeTypes".to_owned(), 1, IOBuffer::I8(NODE_TYPES.to_vec()))]);
        assert_eq!(
            named(attributes.cell),
            [
                ("FaceLabels".to_owned(), 2, IOBuffer::I32(LABELS.as_flattened().to_vec())),
                ("BoundaryId".to_owned(), 1, IOBuffer::I32(BOUNDARIES.to_vec())),
                ("Size".to_owned(), 1, IOBuffer::F64(POINTS[..3].iter().map(|point| point.x).collect())),
                ("Sides".to_owned(), 3, IOBuffer::I32(three.to_vec())),
            ]
        );
    }
}

#[test]
fn empty_data_set_is_a_valid_file() {
    let data = PolyData {
        points: &[],
        cells: Cells::Triangles(&[]),
        point_arrays: vec![],
        cell_arrays: vec![],
        field: vec![],
    };
    for format in VtkFormat::ALL {
        let file = bytes(&data, format);
        match format {
            VtkFormat::Vtk => drop(Vtk::parse_legacy_be(&file[..]).unwrap()),
            _ => drop(Vtk::parse_xml(&inlined(&file)[..]).unwrap()),
        }
    }
}

#[test]
fn number_of_threads_does_not_change_the_file() {
    let points: Vec<DVec3> = (0..200_000).map(|i| DVec3::splat(f64::from(i)).sqrt()).collect();
    let data = PolyData {
        points: &points,
        cells: Cells::Triangles(&TRIANGLES),
        point_arrays: vec![],
        cell_arrays: vec![],
        field: vec![],
    };
    let with_threads = |count| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        VtkFormat::ALL.map(|format| pool.install(|| bytes(&data, format)))
    };
    assert!(with_threads(1) == with_threads(3));
}

#[test]
#[should_panic(expected = "cell array BoundaryId")]
fn array_of_another_length_is_refused() {
    let mut data = surface(Cells::Triangles(&TRIANGLES));
    data.cell_arrays[1].values = Values::slice(&BOUNDARIES[..2]);
    bytes(&data, VtkFormat::Vtp);
}

#[test]
fn polygons_come_back() {
    let polygons = [vec![0, 1, 2, 3], vec![4, 3, 2, 0, 1]];
    for format in VtkFormat::ALL {
        let file = bytes(&surface(Cells::Polygons(&polygons)), format);
        // PolyData do not tell triangles from other polygons.
        let kind = if format == VtkFormat::Vtu { CellType::Polygon } else { CellType::Triangle };
        let expected = polygons.clone().map(|cell| (kind, cell.into_iter().map(u64::from).collect()));
        assert_eq!(check(read(file, format)), expected, "{format:?}");
    }
}

#[test]
fn vectors_come_back() {
    let data = PolyData {
        points: &POINTS,
        cells: Cells::Triangles(&TRIANGLES),
        point_arrays: vec![Array { name: "Normals", values: Values::slice(&POINTS) }],
        cell_arrays: vec![],
        field: vec![],
    };
    let expected: Vec<f64> = POINTS.iter().flat_map(|point| point.to_array()).collect();
    for format in VtkFormat::ALL {
        let attributes = attributes_of(&data, format);
        let arrays = named(attributes.point);
        assert_eq!(arrays, [("Normals".to_owned(), 3, IOBuffer::F64(expected.clone()))], "{format:?}");
    }
}
