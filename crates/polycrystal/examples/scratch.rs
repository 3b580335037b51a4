use glam::DVec3;
use polycrystal::*;
use std::time::Instant;
use voronoi::*;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let n: usize = args[1].parse().unwrap();
    let levels: usize = args[2].parse().unwrap();
    let seeds_range: u64 = args[3].parse().unwrap();
    let time: f64 = args[4].parse().unwrap();
    let flat2 = args.len() > 5;
    for s in 1..=seeds_range {
        let mut state = s.wrapping_mul(0xD1342543DE82EF95) ^ (s << 32);
        let mut rnd = || {
            state = state.wrapping_add(0x9E3779B97F4A7C15);
            let mut z = state;
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58476D1CE4E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D049BB133111EB);
            ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
        };
        let seeds: Vec<DVec3> =
            (0..n).map(|_| DVec3::new(rnd(), rnd(), if flat2 { 0.0 } else { rnd() })).collect();
        let t0 = Instant::now();
        let domain = if flat2 { Domain::unit_square() } else { Domain::unit_cube() };
        let tess = Tessellation::new(&domain, &seeds).unwrap();
        let t1 = Instant::now();
        let (net, flat) = Network::new(&tess, Junctions::Crease, levels).unwrap();
        let t2 = Instant::now();
        let relaxed = relax(&net, &flat, &Relaxation { time }, |_, _| ());
        let t3 = Instant::now();
        match relaxed {
            Ok(r) => {
                let smooth = net.subdivide(&r.control_points);
                let t4 = Instant::now();
                let v = validate(&net, &smooth);
                let t5 = Instant::now();
                let a0 = dihedral_angles(&net, net.control_mesh(), &flat);
                let a1 = dihedral_angles(&net, net.finest(), &smooth);
                let t6 = Instant::now();
                println!(
                    "{s}: tess {:.0?} net {:.0?} relax {:.0?} subd {:.0?} valid {:.0?} angles {:.0?} | {:?} -> {:?} {:?}",
                    t1 - t0,
                    t2 - t1,
                    t3 - t2,
                    t4 - t3,
                    t5 - t4,
                    t6 - t5,
                    a0.map(|a| a.standard_deviation),
                    a1,
                    v
                );
            }
            Err(e) => println!("{s}: {e} {:?}", t3 - t2),
        }
    }
}
