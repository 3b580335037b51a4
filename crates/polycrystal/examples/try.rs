use glam::DVec3;
use polycrystal::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use voronoi::{Domain, Tessellation};
fn main() {
    let a: Vec<f64> = std::env::args().skip(1).map(|x| x.parse().unwrap()).collect();
    let (count, levels, first, last, time) = (a[0] as usize, a[1] as usize, a[2] as u64, a[3] as u64, a[4]);
    for seed in first..=last {
        let domain = Domain::unit_cube();
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        let mut f = || (generator.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        let seeds: Vec<DVec3> = (0..count).map(|_| DVec3::new(f(), f(), f())).collect();
        let tess = Tessellation::new(&domain, &seeds).unwrap();
        let t0 = std::time::Instant::now();
        let volumes: Vec<f64> = tess.cell_measures().iter().map(|c| c.volume).collect();
        let l = a[5] * (1.0 / count as f64).cbrt();
        let (tess, collapsed) = if l > 0.0 { tess.regularized(l, a[5]) } else { (tess, Default::default()) };
        println!("{collapsed:?} of {} edges {} faces", tess.edges().ends.len(), tess.face_count());
        let (network, flat) = Network::new(&tess, Junctions::Crease, levels).unwrap();
        let network = network.with_cell_volumes(volumes);
        let t1 = std::time::Instant::now();
        let r = relax(&network, &flat, &Relaxation { time }, |_, _| ());
        let t2 = std::time::Instant::now();
        let r = match r { Ok(r) => r, Err(e) => { println!("seed {seed}: {e} {:.2?}", t2 - t1); continue; } };
        let smooth = network.subdivide_between(r.level, levels, &r.points);
        let before = dihedral_angles(&network, network.finest(), &network.subdivide(&flat)).unwrap();
        let after = dihedral_angles(&network, network.finest(), &smooth).unwrap();
        let v = validate(&network, &smooth);
        println!("seed {seed}: {:.2} -> {:.2} mean {:.2} {:?} net {:.2?} relax {:.2?}", before.standard_deviation, after.standard_deviation, after.mean, v.map(|v| v.largest_volume_error), t1 - t0, t2 - t1);
    }
}
