//! Domains from files: convex surfaces and half-spaces.

use std::fs;
use std::path::Path;

use glam::DVec3;
use voronoi::{Dimension, Domain, VoronoiError, WallPlane};

use crate::Error;
use crate::files::TEXT_FILE;
use crate::mesh::file::read_mesh;

/// The body in the surface of a mesh file.
///
/// # Errors
/// As of [`read_mesh`]; [`Error::DomainInFile`] when the surface is not closed and convex.
pub(crate) fn surface_domain(path: &Path) -> Result<Domain, Error> {
    let mesh = read_mesh(path)?;
    Domain::convex_surface(&mesh.points, &mesh.faces)
        .map_err(|cause| Error::DomainInFile { path: path.to_owned(), cause })
}

/// What the half-spaces of a text file have in common: on each line the outward normal and the distance in units of its length,
/// `nx, ny, nz, d`, or `nx, ny, d` in 2D, between commas or blanks. Empty lines and lines that begin with `#` are skipped, and
/// so is a first line of names.
///
/// # Errors
/// [`Error::Unreadable`]; [`Error::BadHalfSpaceLine`] and [`Error::HalfSpaceInFile`] name a line,
/// [`Error::DomainInFile`] what is wrong with all of them.
pub(crate) fn half_space_domain(path: &Path, dimension: Dimension) -> Result<Domain, Error> {
    let text = fs::read_to_string(path).map_err(|cause| Error::Unreadable {
        path: path.to_owned(),
        kind: TEXT_FILE,
        cause,
    })?;
    let (mut walls, mut lines) = (Vec::new(), Vec::new());
    for (line, text) in (1..).zip(text.lines().map(|line| line.trim_start_matches('\u{feff}').trim())) {
        if text.is_empty() || text.starts_with('#') {
            continue;
        }
        let columns = text.split(|separator: char| separator == ',' || separator.is_whitespace());
        let columns: Vec<&str> = columns.filter(|column| !column.is_empty()).collect();
        let numbers: Vec<f64> = columns.iter().filter_map(|column| column.parse().ok()).collect();
        if walls.is_empty() && numbers.is_empty() && !columns.is_empty() {
            continue;
        }
        let half_space = match (dimension, numbers.as_slice()) {
            _ if numbers.len() != columns.len() => None,
            (Dimension::Three, &[x, y, z, offset]) => Some((DVec3::new(x, y, z), offset)),
            (Dimension::Two, &[x, y, offset]) => Some((DVec3::new(x, y, 0.0), offset)),
            _ => None,
        };
        let Some((normal, offset)) = half_space else {
            return Err(Error::BadHalfSpaceLine { path: path.to_owned(), line, dimension });
        };
        walls.push(WallPlane::HalfSpace { normal, offset });
        lines.push(line);
    }
    let domain = match dimension {
        Dimension::Three => Domain::polyhedron(walls),
        Dimension::Two => Domain::polygon(walls),
    };
    domain.map_err(|cause| match cause {
        VoronoiError::BadHalfSpace { wall }
        | VoronoiError::FarHalfSpace { wall, .. }
        | VoronoiError::EmptyDomain { wall } => {
            Error::HalfSpaceInFile { path: path.to_owned(), line: lines[wall], cause }
        }
        _ => Error::DomainInFile { path: path.to_owned(), cause },
    })
}
