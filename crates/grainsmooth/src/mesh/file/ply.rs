//! PLY, text and binary, through `ply_rs_bw`.

use glam::DVec3;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};

use super::{MeshFile, MeshFileProblem};

/// Reads the elements `vertex` and `face`; everything else is passed over.
pub(super) fn read(bytes: &[u8]) -> Result<MeshFile, MeshFileProblem> {
    let problem = |error| MeshFileProblem::corrupt("PLY", error);
    let mut reader = Reader::new(bytes);
    let parser = Parser::<Element>::new();
    let header = parser.read_header(&mut reader).map_err(problem)?;
    let mut mesh = MeshFile::default();
    for (name, definition) in &header.elements {
        if name == "vertex" {
            for axis in ["x", "y", "z"] {
                if !definition.properties.contains_key(axis) {
                    return Err(MeshFileProblem::corrupt("PLY", format!("its vertices have no {axis}")));
                }
            }
        }
        let elements = parser.read_payload_for_element(&mut reader, definition, &header).map_err(problem)?;
        match name.as_str() {
            "vertex" => mesh.points = elements.iter().map(|element| element.point).collect(),
            "face" => {
                for (face, element) in elements.into_iter().enumerate() {
                    let corners = element.corners.ok_or_else(|| {
                        MeshFileProblem::corrupt("PLY", format!("face {face} has no list vertex_indices"))
                    })?;
                    mesh.faces.push(corners);
                }
            }
            _ => {}
        }
    }
    Ok(mesh)
}

/// What is read of an element, be it a vertex or a face.
#[derive(Default)]
struct Element {
    point: DVec3,
    corners: Option<Vec<u32>>,
}

impl PropertyAccess for Element {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        match name {
            "x" | "y" | "z" => {
                let Some(number) = number(&value) else { return PropertyAccessResult::UnsupportedType };
                match name {
                    "x" => self.point.x = number,
                    "y" => self.point.y = number,
                    _ => self.point.z = number,
                }
                PropertyAccessResult::Set
            }
            "vertex_indices" | "vertex_index" => {
                self.corners = value.to_u32_list();
                match self.corners {
                    Some(_) => PropertyAccessResult::Set,
                    None => PropertyAccessResult::UnsupportedType,
                }
            }
            _ => PropertyAccessResult::Ignored,
        }
    }
}

fn number(value: &Property) -> Option<f64> {
    match *value {
        Property::Char(value) => Some(value.into()),
        Property::UChar(value) => Some(value.into()),
        Property::Short(value) => Some(value.into()),
        Property::UShort(value) => Some(value.into()),
        Property::Int(value) => Some(value.into()),
        Property::UInt(value) => Some(value.into()),
        Property::Float(value) => Some(value.into()),
        Property::Double(value) => Some(value),
        _ => None,
    }
}
