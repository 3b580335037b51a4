//! Seeds of any kind in any box, periodic or not, weighted or not: what is accepted is a cell complex that fills the domain,
//! with closed cells, vertices that differ and copies that match. What is refused must be refused with an error.
#![no_main]

#[path = "../../crates/voronoi/tests/common/exact_vertices.rs"]
mod exact_vertices;

use std::collections::HashMap;

use exact_vertices::assert_vertices_differ;
use glam::{BVec3, DVec3};
use libfuzzer_sys::arbitrary::{self, Arbitrary};
use libfuzzer_sys::fuzz_target;
use voronoi::{Dimension, Domain, Side, Tessellation};

/// Seeds at most: more only take longer.
const SEEDS: usize = 40;

#[derive(Arbitrary, Debug)]
struct Input {
    flat: bool,
    /// Powers of two, as the sides of the box.
    sides: [i8; 3],
    lower: [i8; 3],
    periodic: [bool; 3],
    /// Coordinates are multiples of one part in so many of a side.
    grid: u8,
    seeds: Vec<Seed>,
    radii: Option<Vec<u8>>,
}

#[derive(Arbitrary, Debug)]
struct Seed {
    place: [u8; 3],
    /// Last places by which each coordinate is off the grid.
    jitter: [i8; 3],
    /// Anywhere in the box instead, in 65536ths of a side.
    free: Option<[u16; 3]>,
}

impl Input {
    fn domain(&self) -> Option<Domain> {
        let side = |axis: usize| 2f64.powi(i32::from(self.sides[axis] % 11));
        let size = DVec3::new(side(0), side(1), side(2));
        let lower = DVec3::from_array(self.lower.map(|tenths| f64::from(tenths) / 10.0)) * size;
        let domain = if self.flat {
            Domain::rectangle(lower, lower + size)
        } else {
            Domain::cuboid(lower, lower + size)
        };
        domain.ok().map(|domain| domain.with_periods(BVec3::from_array(self.periodic)))
    }

    fn position(&self, seed: &Seed, domain: &Domain) -> DVec3 {
        let grid = f64::from(self.grid % 12 + 1);
        let fraction = |axis: usize| match seed.free {
            Some(free) => f64::from(free[axis]) / 65536.0,
            None => {
                let on_grid = (f64::from(seed.place[axis]) % (grid + 1.0)) / grid;
                on_grid + f64::from(seed.jitter[axis]) * f64::EPSILON
            }
        };
        let position = domain.lower() + DVec3::new(fraction(0), fraction(1), fraction(2)) * domain.size();
        position.clamp(domain.lower(), domain.upper())
    }
}

fuzz_target!(|input: Input| {
    let Some(domain) = input.domain() else { return };
    let seeds: Vec<DVec3> =
        input.seeds.iter().take(SEEDS).map(|seed| input.position(seed, &domain)).collect();
    let weights: Option<Vec<f64>> = input.radii.as_ref().filter(|radii| !radii.is_empty()).map(|radii| {
        let unit = domain.measure().powf(1.0 / if input.flat { 2.0 } else { 3.0 }) / 512.0;
        (0..seeds.len()).map(|k| (f64::from(radii[k % radii.len()]) * unit).powi(2)).collect()
    });
    let tessellation = match &weights {
        Some(weights) => Tessellation::power(&domain, &seeds, weights),
        None => Tessellation::new(&domain, &seeds),
    };
    if let Ok(tessellation) = tessellation {
        check(&tessellation);
        assert_vertices_differ(&tessellation, weights.as_deref());
    }
});

fn check(tessellation: &Tessellation) {
    let domain = tessellation.domain();
    let whole = domain.measure();
    let volumes: Vec<f64> = tessellation.cell_measures().iter().map(|cell| cell.volume).collect();
    assert!((volumes.iter().sum::<f64>() - whole).abs() <= 1e-12 * whole, "volumes do not fill the domain");
    // A cell between seeds a last place apart is thinner than its vertices' rounding.
    assert!(volumes.iter().all(|volume| *volume >= -1e-14 * whole), "a cell is inside out");

    let edges = tessellation.edges();
    let cells = tessellation.cell_count() - tessellation.empty_cells().len();
    let vertices = tessellation.vertices().len() - tessellation.periodic_vertices().len();
    let faces = tessellation.face_count() - tessellation.periodic_faces().len();
    let euler = usize::from(!domain.is_periodic());
    match domain.dimension() {
        Dimension::Two => assert_eq!(vertices + cells, faces + euler),
        Dimension::Three => {
            let edges = edges.ends.len() - tessellation.periodic_edges(&edges).len();
            assert_eq!(vertices + faces, edges + cells + euler);
            assert_closed(tessellation);
        }
    }
    for pair in tessellation.periodic_faces() {
        let [primary, secondary] = [pair.primary, pair.secondary].map(|face| tessellation.face_sides(face));
        let [Side::Cell(a), Side::Image(b, translation)] = primary else { panic!("{primary:?} has a copy") };
        let [Side::Cell(c), Side::Image(d, back)] = secondary else { panic!("{secondary:?} is a copy") };
        assert!(a == d && b == c && translation.0.iter().zip(back.0).all(|(there, back)| *there == -back));
    }
}

/// Each edge of a cell is walked once each way.
fn assert_closed(tessellation: &Tessellation) {
    let mut walks = HashMap::new();
    for face in tessellation.faces() {
        let corners = tessellation.face_corners(face);
        let [first, second] = tessellation.face_sides(face);
        for (&from, &to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            *walks.entry((first, from, to)).or_insert(0) += 1;
            *walks.entry((second, to, from)).or_insert(0) += 1;
        }
    }
    for (&(side, from, to), count) in &walks {
        if matches!(side, Side::Cell(_)) {
            assert!(*count == 1 && walks.contains_key(&(side, to, from)), "{side:?} is open");
        }
    }
}
