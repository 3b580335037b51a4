//! What Gmsh writes: nodes and tetrahedra of its format 4.1, as text. Its older format numbers nodes anew.
//!
//! <https://gmsh.info/doc/texinfo/gmsh.html#MSH-file-format>

use std::collections::BTreeMap;
use std::str::FromStr;

use glam::DVec3;
use polycrystal::GrainId;

use crate::volume_mesh::{VolumeMesh, volume};

/// Gmsh's code for tetrahedra.
const TETRAHEDRON: usize = 4;

/// Reads tetrahedra between points of a surface, which have its numbers, counted from 1, in volumes of these grains, counted so too.
pub(super) fn read(text: &str, surface: Vec<DVec3>, grain_of: &[GrainId]) -> Result<VolumeMesh, String> {
    // Those of the surface stay bit for bit as they were; those inside follow in their order.
    let (surface_points, mut points) = (surface.len(), surface);
    let mut inner = BTreeMap::new();
    let mut lines = section(text, "$Nodes")?;
    let [blocks, ..] = numbers(&mut lines)?[..] else { return Err("Gmsh wrote no nodes".to_owned()) };
    for _ in 0..blocks {
        let [_, _, _, count] = numbers(&mut lines)?[..] else {
            return Err("Gmsh wrote a broken block".to_owned());
        };
        let tags: Vec<usize> =
            (0..count).map(|_| number(lines.next().unwrap_or_default())).collect::<Result<_, _>>()?;
        for tag in tags {
            let words = lines.next().unwrap_or_default().split(' ');
            let place: Vec<f64> = words.map(number).collect::<Result<_, _>>()?;
            if tag > surface_points {
                let place = <[f64; 3]>::try_from(place).map_err(|_| "Gmsh wrote a broken node".to_owned())?;
                inner.insert(tag, DVec3::from(place));
            }
        }
    }
    let tags: Vec<usize> = inner.keys().copied().collect();
    points.extend(inner.into_values());
    let point = |tag: usize| {
        let place = match tags.binary_search(&tag) {
            Ok(place) => Some(surface_points + place),
            Err(_) => tag.checked_sub(1).filter(|place| *place < surface_points),
        };
        place.and_then(|place| u32::try_from(place).ok()).ok_or_else(|| format!("Gmsh wrote no node {tag}"))
    };
    let (mut tetrahedra, mut grains) = (Vec::new(), Vec::new());
    let mut lines = section(text, "$Elements")?;
    let [blocks, ..] = numbers(&mut lines)?[..] else { return Err("Gmsh wrote no elements".to_owned()) };
    for _ in 0..blocks {
        let [_, entity, kind, count] = numbers(&mut lines)?[..] else {
            return Err("Gmsh wrote a broken block".to_owned());
        };
        for _ in 0..count {
            let element = numbers(&mut lines)?;
            if kind != TETRAHEDRON {
                continue;
            }
            let [_, a, b, c, d] = element[..] else {
                return Err("Gmsh wrote a broken tetrahedron".to_owned());
            };
            let mut corners = [point(a)?, point(b)?, point(c)?, point(d)?];
            if volume(corners.map(|corner| points[corner as usize])) < 0.0 {
                corners.swap(0, 1);
            }
            tetrahedra.push(corners);
            let grain = entity.checked_sub(1).and_then(|volume| grain_of.get(volume));
            grains.push(*grain.ok_or("Gmsh wrote a tetrahedron of no grain")?);
        }
    }
    let mut mesh = VolumeMesh { surface_points, points, tetrahedra, grains, ..VolumeMesh::default() };
    mesh.sort_by_grain();
    Ok(mesh)
}

/// The lines of a section.
fn section<'a>(text: &'a str, name: &str) -> Result<impl Iterator<Item = &'a str>, String> {
    let (_, lines) = text.split_once(name).ok_or_else(|| format!("Gmsh wrote no {name}"))?;
    Ok(lines.lines().skip(1))
}

/// The numbers in the next line.
fn numbers<'a>(lines: &mut impl Iterator<Item = &'a str>) -> Result<Vec<usize>, String> {
    lines.next().unwrap_or_default().split_whitespace().map(number).collect()
}

fn number<T: FromStr>(word: &str) -> Result<T, String> {
    word.parse().map_err(|_| format!("Gmsh wrote `{word}` for a number"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_of_the_surface_keep_their_bits_and_tetrahedra_their_grains() {
        let surface = [DVec3::ZERO, DVec3::X * (1.0 / 3.0), DVec3::Y, DVec3::Z];
        let text = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n2 5 1 9\n2 1 0 4\n1\n2\n3\n4\n0 0 0\n0.3333333333 0 0\n0 1 0\n0 0 1\n3 1 0 1\n9\n0.1 0.1 0.1\n$EndNodes\n\
            $Elements\n3 3 1 3\n2 1 2 1\n1 1 2 3\n3 1 4 1\n2 2 1 3 9\n3 2 4 1\n3 1 2 9 4\n$EndElements\n";
        let mesh = read(text, surface.to_vec(), &[GrainId(1), GrainId(0)]).expect("a mesh");
        assert_eq!(mesh.points[..4], surface);
        assert_eq!(mesh.points[4], DVec3::splat(0.1));
        // The second is of the first grain, and so comes first.
        assert_eq!(mesh.grains, [GrainId(0), GrainId(1)]);
        assert!(mesh.tetrahedra[0].contains(&3) && !mesh.tetrahedra[1].contains(&3));
        assert!((0..2).all(|tetrahedron| volume(mesh.corners(tetrahedron)) > 0.0));
        assert!(
            read("$Nodes\nx\n", surface.to_vec(), &[]).is_err()
                && read(text, surface.to_vec(), &[GrainId(0)]).is_err()
        );
    }
}
