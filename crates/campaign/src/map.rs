//! Measured maps: what a run of `grainsmooth smooth` is given.

use std::fmt::{Display, Write as _};

use crate::draw::Draw;

/// Labels of voxels, x fastest; in the plane, of the pixels of a single layer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LabelledGrid {
    /// Number of voxels along each axis.
    pub shape: [u32; 3],
    /// What the map is like, in a word or two.
    pub kind: &'static str,
    /// Labels; 0 is that of pores, where there are any.
    pub labels: Vec<u8>,
}

impl LabelledGrid {
    /// Draws grains: cells, layers, blocks or mere noise.
    pub fn draw(draw: &mut Draw, dimension: usize) -> Self {
        let most = if dimension == 2 { 60 } else { 20 };
        let mut shape = [0; 3].map(|_: u32| draw.whole(3..=most));
        if dimension == 2 {
            shape[2] = 1;
        }
        let kind = draw.weighted(&[
            (0.35, "cells"),
            (0.2, "cells with noise"),
            (0.2, "cells with pores"),
            (0.1, "blocks"),
            (0.08, "layers"),
            (0.07, "noise"),
        ]);
        let mut grid = Self { shape, kind, labels: Vec::new() };
        match kind {
            "blocks" => grid.pile_blocks(draw),
            "layers" => {
                let thickness = draw.whole(1..=4);
                grid.fill(|[x, y, z]| (x + (y + z) / 3) / thickness + 1);
            }
            "noise" => {
                let labels = draw.whole(2..=5);
                grid.fill(|_| draw.whole(1..=labels));
            }
            _ => grid.make_cells(draw),
        }
        match kind {
            "cells with noise" => {
                let share = draw.magnitude(0.002, 0.1);
                let count = grid.labels.len();
                for voxel in 0..count {
                    if draw.chance(share) {
                        grid.labels[voxel] = draw.one_of(&grid.labels.clone());
                    }
                }
            }
            "cells with pores" => grid.make_pores(draw),
            _ => {}
        }
        grid
    }

    fn places(&self) -> impl Iterator<Item = [u32; 3]> + use<> {
        let [nx, ny, nz] = self.shape;
        (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
    }

    /// Labels beyond 255 begin again at 1.
    fn fill(&mut self, mut label: impl FnMut([u32; 3]) -> u32) {
        let small = |label: u32| u8::try_from((label - 1) % 255 + 1).unwrap_or(1);
        self.labels = self.places().map(|place| small(label(place))).collect();
    }

    /// Each voxel is of the nearest seed; lengths along the axes differ.
    fn make_cells(&mut self, draw: &mut Draw) {
        let count = draw.count(60);
        let lengths = [0; 3].map(|_| draw.magnitude(0.5, 2.0));
        let seeds: Vec<[f64; 3]> =
            (0..count).map(|_| self.shape.map(|voxels| draw.between(0.0, f64::from(voxels)))).collect();
        let nearest = |place: [u32; 3]| {
            let distance = |seed: &[f64; 3]| -> f64 {
                let along = |axis: usize| (f64::from(place[axis]) + 0.5 - seed[axis]) * lengths[axis];
                (0..3).map(|axis| along(axis).powi(2)).sum()
            };
            (1..)
                .zip(&seeds)
                .min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))
                .map_or(1, |(label, _)| label)
        };
        self.fill(nearest);
    }

    fn pile_blocks(&mut self, draw: &mut Draw) {
        self.fill(|_| 1);
        for label in 2..2 + draw.whole(1..=20) {
            let ranges = self.shape.map(|voxels| {
                let first = draw.whole(0..=voxels - 1);
                first..=draw.whole(first..=voxels - 1)
            });
            let places = self.places();
            for (voxel, place) in self.labels.iter_mut().zip(places) {
                if (0..3).all(|axis| ranges[axis].contains(&place[axis])) {
                    *voxel = u8::try_from(label).unwrap_or(1);
                }
            }
        }
    }

    fn make_pores(&mut self, draw: &mut Draw) {
        for _ in 0..draw.whole(1..=4) {
            let middle = self.shape.map(|voxels| draw.between(0.0, f64::from(voxels)));
            let radius = draw.between(0.6, 4.0);
            let places = self.places();
            for (voxel, place) in self.labels.iter_mut().zip(places) {
                let along = |axis: usize| f64::from(place[axis]) + 0.5 - middle[axis];
                if (0..3).map(|axis| along(axis).powi(2)).sum::<f64>() < radius * radius {
                    *voxel = 0;
                }
            }
        }
    }

    /// An array as NumPy writes it: indices x, y, z, or z, y, x.
    pub fn npy(&self, is_zyx: bool) -> Vec<u8> {
        let [nx, ny, nz] = self.shape;
        let mut shape = if nz == 1 { vec![nx, ny] } else { vec![nx, ny, nz] };
        if is_zyx {
            shape.reverse();
        }
        npy(&shape, &self.labels, !is_zyx)
    }

    /// An image for VTK, with spacing and origin.
    pub fn vti(&self, spacing: [f64; 3]) -> String {
        let [nx, ny, nz] = self.shape;
        let [dx, dy, dz] = spacing;
        let labels: Vec<String> = self.labels.iter().map(u8::to_string).collect();
        format!(
            r#"<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64"><ImageData WholeExtent="0 {nx} 0 {ny} 0 {nz}" Origin="1 -2 3" Spacing="{dx} {dy} {dz}"><Piece Extent="0 {nx} 0 {ny} 0 {nz}"><CellData><DataArray type="UInt8" Name="material" format="ascii">{}</DataArray></CellData></Piece></ImageData></VTKFile>"#,
            labels.join(" ")
        )
    }
}

/// An array of whole numbers as NumPy writes it, with the first or the last index fastest.
pub fn npy(shape: &[impl Display], numbers: &[u8], is_first_fastest: bool) -> Vec<u8> {
    let shape: String = shape.iter().map(|count| format!("{count}, ")).collect();
    let order = if is_first_fastest { "True" } else { "False" };
    let mut header = format!("{{'descr': '|u1', 'fortran_order': {order}, 'shape': ({shape}), }}");
    header.extend(std::iter::repeat_n(' ', 117 - header.len()));
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    bytes.extend(header.as_bytes());
    bytes.push(b'\n');
    bytes.extend(numbers);
    bytes
}

/// Orientations of the grains of a map, in degrees, and what of its points is not known.
#[derive(Debug, Clone, PartialEq)]
pub struct Orientations {
    /// Euler angles of each point; none where it has no solution.
    points: Vec<Option<[f64; 3]>>,
    step: f64,
}

impl Orientations {
    /// Draws an orientation for each grain, with a little scatter.
    pub fn draw(draw: &mut Draw, grid: &LabelledGrid) -> Self {
        let of_grains: Vec<[f64; 3]> = (0..256)
            .map(|_| [draw.between(0.0, 360.0), draw.between(0.0, 180.0), draw.between(0.0, 360.0)])
            .collect();
        let scatter = draw.between(0.0, 2.0);
        let missing = if draw.chance(0.5) { 0.0 } else { draw.magnitude(0.005, 0.3) };
        let step = draw.magnitude(0.01, 10.0);
        let point = |label: &u8| {
            let [first, second, third] = of_grains[usize::from(*label)];
            let turned = first + draw.between(-scatter, scatter);
            (*label != 0 && !draw.chance(missing)).then_some([turned, second, third])
        };
        Self { points: grid.labels.iter().map(point).collect(), step }
    }

    /// One layer as EDAX writes it, on a square grid or one where every other row is shifted by half a step.
    pub fn ang(&self, shape: [u32; 3], layer: u32, is_hexagonal: bool) -> String {
        let mut text = "# Phase 1\n# MaterialName  Nickel\n# Symmetry  43\n#\n# GRID: SqrGrid\n".to_owned();
        if is_hexagonal {
            text = text.replace("SqrGrid", "HexGrid");
        }
        for ([column, row], angles) in self.layer(shape, layer) {
            let shift = if is_hexagonal && row % 2 == 1 { 0.5 } else { 0.0 };
            let height = if is_hexagonal { 0.75f64.sqrt() } else { 1.0 };
            let (x, y) = ((f64::from(column) + shift) * self.step, f64::from(row) * height * self.step);
            let [phi1, phi, phi2] = angles.unwrap_or([720.0; 3]).map(f64::to_radians);
            let confidence = if angles.is_some() { 0.9 } else { -1.0 };
            // Writing to a string does not fail.
            let _ = writeln!(text, " {phi1:.5} {phi:.5} {phi2:.5} {x:.7} {y:.7} 100.0 {confidence} 0 1 0.8");
        }
        text
    }

    /// One layer as Oxford writes it.
    pub fn ctf(&self, shape: [u32; 3], layer: u32) -> String {
        let [columns, rows, _] = shape;
        let mut text = format!(
            "Channel Text File\nJobMode\tGrid\nXCells\t{columns}\nYCells\t{rows}\nXStep\t{0}\nYStep\t{0}\nPhases\t1\n3.5;3.5;3.5\t90;90;90\tNickel\t11\t225\nPhase\tX\tY\tBands\tError\tEuler1\tEuler2\tEuler3\tMAD\tBC\tBS\n",
            self.step
        );
        for ([column, row], angles) in self.layer(shape, layer) {
            let (x, y) = (f64::from(column) * self.step, f64::from(row) * self.step);
            let phase = u8::from(angles.is_some());
            let [phi1, phi, phi2] = angles.unwrap_or([0.0; 3]);
            let _ = writeln!(
                text,
                "{phase}\t{x:.7}\t{y:.7}\t8\t0\t{phi1:.4}\t{phi:.4}\t{phi2:.4}\t0.5\t100\t100"
            );
        }
        text
    }

    /// Columns and rows of a layer, with the angles there.
    fn layer(&self, shape: [u32; 3], layer: u32) -> impl Iterator<Item = ([u32; 2], Option<[f64; 3]>)> {
        let [columns, rows, _] = shape;
        let first = (columns * rows * layer) as usize;
        let places = (0..rows).flat_map(move |row| (0..columns).map(move |column| [column, row]));
        places.zip(self.points[first..].iter().copied())
    }
}
