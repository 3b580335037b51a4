//! Measured maps whose files are damaged.

use std::path::Path;

use grainsmooth::{MapOptions, read_map};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Bytes of a file are flipped or cut off: there is a map, or an error in one line.
#[test]
fn damaged_maps_are_read_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/maps");
    for name in ["volume_damask.vti", "volume_points.vti", "volume.npy", "volume_zyx_c.npy"] {
        let whole = std::fs::read(data.join(name)).unwrap();
        let path = folder.path().join(name);
        let mut generator = ChaCha8Rng::seed_from_u64(23);
        let mut refused = 0;
        for _ in 0..200 {
            let mut bytes = whole.clone();
            let number = generator.next_u64();
            // What is broken is the head of the file more often than its numbers.
            let place = |number: u64, within: usize| usize::try_from(number % within as u64).unwrap();
            let within = if number % 2 == 0 { whole.len() } else { whole.len().min(900) };
            match number / 2 % 3 {
                0 => bytes.truncate(place(generator.next_u64(), within)),
                1 => bytes[place(generator.next_u64(), within)] ^= 1 << (number / 6 % 8),
                _ => {
                    let at = place(generator.next_u64(), within);
                    bytes[at] = b"0123456789-\"<> "[place(generator.next_u64(), 15)];
                }
            }
            std::fs::write(&path, &bytes).unwrap();
            match read_map(&path, &MapOptions { min_voxels: 1, ..MapOptions::default() }) {
                Ok(map) => assert_eq!(map.map.labels.len(), map.map.shape.iter().product::<usize>()),
                Err(error) => {
                    refused += 1;
                    let said = error.to_string();
                    assert!(said.starts_with(&*path.to_string_lossy()) && !said.contains('\n'), "{said}");
                }
            }
        }
        assert!(refused > 20, "{name}: {refused}");
    }
}
