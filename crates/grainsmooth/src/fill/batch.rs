//! Grains that one run of Gmsh fills: those near one another.
//!
//! The triangles between grains stay, so grains can be filled apart from one another. Gmsh is given their triangles and nothing else: in its own lists it looks up names and numbers one by
//! one, which took 14 minutes for the boundaries of 10 000 grains.

use std::collections::BTreeSet;
use std::io::{self, Write};

use glam::DVec3;
use polycrystal::GrainId;

use crate::formats::connected::{bounds, pieces_of_grain, volume};
use crate::formats::gmsh::TRIANGLE;
use crate::formats::surface::Surface;

/// A connected piece of a grain.
struct Piece {
    grain: GrainId,
    /// The parts of its surface by number; true for those whose normals point inward.
    parts: Vec<(usize, bool)>,
    centre: DVec3,
    triangles: usize,
}

/// Pieces of grains, with points of their own.
pub(super) struct Batch<'a> {
    surface: &'a Surface<'a>,
    pieces: Vec<Piece>,
    /// The parts of their surfaces, each once.
    parts: BTreeSet<usize>,
    /// The points of these by number, in order.
    numbers: Vec<u32>,
}

impl<'a> Batch<'a> {
    /// All grains within a surface of connected parts. Batches of more than so many triangles are halved, those between two pieces counted for both.
    pub(super) fn all(surface: &'a Surface<'a>, grain_count: usize, limit: usize) -> Vec<Self> {
        let mut pieces = Vec::new();
        for (grain, parts) in (0u32..).map(GrainId).zip(surface.parts_of_grains(grain_count)) {
            pieces.extend(pieces_of_grain(surface, &parts).into_iter().map(|parts| {
                let bounds = bounds(surface, &parts);
                let triangles = parts.iter().map(|(part, _)| triangle_count(surface, *part)).sum();
                Piece { grain, parts, centre: bounds.start.midpoint(bounds.end), triangles }
            }));
        }
        let mut batches = Vec::new();
        halve(pieces, limit, &mut batches);
        batches.into_iter().map(|pieces| Self::new(surface, pieces)).collect()
    }

    /// A batch for each piece.
    pub(super) fn into_pieces(self) -> impl Iterator<Item = Self> {
        self.pieces.into_iter().map(move |piece| Self::new(self.surface, vec![piece]))
    }

    fn new(surface: &'a Surface<'a>, pieces: Vec<Piece>) -> Self {
        let parts: BTreeSet<usize> =
            pieces.iter().flat_map(|piece| &piece.parts).map(|(part, _)| *part).collect();
        let mut numbers: Vec<u32> =
            parts.iter().flat_map(|part| surface.triangles_of(&surface.parts[*part]).flatten()).collect();
        numbers.sort_unstable();
        numbers.dedup();
        Self { surface, pieces, parts, numbers }
    }

    /// The points of the surface by their numbers there, in the order that they have here.
    pub(super) fn numbers(&self) -> &[u32] {
        &self.numbers
    }

    pub(super) fn points(&self) -> Vec<DVec3> {
        self.numbers.iter().map(|number| self.surface.points[*number as usize]).collect()
    }

    /// The grain of each of Gmsh's volumes.
    pub(super) fn grains(&self) -> Vec<GrainId> {
        self.pieces.iter().map(|piece| piece.grain).collect()
    }

    /// The volume of each of so many grains, as far as it lies in this batch.
    pub(super) fn grain_volumes(&self, count: usize) -> Vec<f64> {
        let mut volumes = vec![0.0; count];
        for piece in &self.pieces {
            volumes[piece.grain.index()] += volume(self.surface, &piece.parts);
        }
        volumes
    }

    /// The triangles of a part, between points of this batch.
    fn triangles_of(&self, part: usize) -> impl Iterator<Item = [u32; 3]> {
        let own = |number: u32| {
            let place = self.numbers.binary_search(&number).expect("all points of its parts are listed");
            u32::try_from(place).expect("no more points than there are numbers for")
        };
        self.surface.triangles_of(&self.surface.parts[part]).map(move |corners| corners.map(own))
    }

    /// Number of triangles.
    pub(super) fn count(&self) -> usize {
        self.parts.iter().map(|part| triangle_count(self.surface, *part)).sum()
    }

    /// The edges of all triangles, the lower end first.
    pub(super) fn edges(&self) -> BTreeSet<[u32; 2]> {
        let triangles = self.parts.iter().flat_map(|part| self.triangles_of(*part));
        let edges = triangles.flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]);
        edges.map(|[a, b]| [a.min(b), a.max(b)]).collect()
    }

    /// Writes the parts as surfaces of Gmsh, without the curves and points that it would only look up.
    pub(super) fn write_surface(&self, out: &mut dyn Write) -> io::Result<()> {
        let (parts, points) = (self.parts.len(), self.numbers.len());
        writeln!(out, "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 {parts} 0")?;
        for part in &self.parts {
            // Its box is not read.
            writeln!(out, "{} 0 0 0 0 0 0 0 0", part + 1)?;
        }
        // Points belong to one surface; which is the same to those that share them.
        let first = self.parts.first().map_or(0, |part| part + 1);
        writeln!(out, "$EndEntities\n$Nodes\n1 {points} 1 {points}\n2 {first} 0 {points}")?;
        (1..=points).try_for_each(|number| writeln!(out, "{number}"))?;
        for DVec3 { x, y, z } in self.points() {
            writeln!(out, "{x:?} {y:?} {z:?}")?;
        }
        let triangles = self.count();
        writeln!(out, "$EndNodes\n$Elements\n{parts} {triangles} 1 {triangles}")?;
        let mut element = 1u64..;
        for part in &self.parts {
            writeln!(out, "2 {} {TRIANGLE} {}", part + 1, triangle_count(self.surface, *part))?;
            for ([a, b, c], element) in self.triangles_of(*part).zip(&mut element) {
                writeln!(out, "{element} {} {} {}", a + 1, b + 1, c + 1)?;
            }
        }
        writeln!(out, "$EndElements")
    }

    /// Writes the script that reads the surfaces from the file of a name, with a volume for each piece, numbered from 1. As one physical volume they are written without the surfaces.
    pub(super) fn write_script(&self, surface: &str, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "Merge \"{surface}\";")?;
        for (tag, piece) in (1..).zip(&self.pieces) {
            let surfaces = piece
                .parts
                .iter()
                .map(|(part, is_inward)| format!("{}{}", if *is_inward { "-" } else { "" }, part + 1));
            let surfaces: Vec<String> = surfaces.collect();
            writeln!(out, "Surface Loop({tag}) = {{{}}};\nVolume({tag}) = {{{tag}}};", surfaces.join(", "))?;
        }
        writeln!(out, "Physical Volume(1) = {{1:{}}};", self.pieces.len())
    }
}

fn triangle_count(surface: &Surface<'_>, part: usize) -> usize {
    surface.numbers_of(&surface.parts[part]).len()
}

/// Halves pieces across the longest side of the box around them, until no more triangles than this are around each batch.
fn halve(mut pieces: Vec<Piece>, limit: usize, batches: &mut Vec<Vec<Piece>>) {
    if pieces.len() < 2 || pieces.iter().map(|piece| piece.triangles).sum::<usize>() <= limit {
        batches.push(pieces);
        return;
    }
    let around = |find: fn(DVec3, DVec3) -> DVec3| {
        pieces.iter().map(|piece| piece.centre).reduce(find).unwrap_or_default()
    };
    let axis = (around(DVec3::max) - around(DVec3::min)).max_position();
    // Where centres are as far along, pieces keep the order of their grains.
    pieces.sort_by(|a, b| a.centre[axis].total_cmp(&b.centre[axis]));
    let upper = pieces.split_off(pieces.len() / 2);
    halve(pieces, limit, batches);
    halve(upper, limit, batches);
}
