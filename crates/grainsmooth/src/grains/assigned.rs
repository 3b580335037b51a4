//! Which of some volumes are of which phase.

use texture::Apportionment;

/// The phase of each of some volumes, so that phases have such shares of the sum and grains alike in size.
///
/// They go, the largest first, as [`Apportionment`] has it. Each phase gets one at least.
pub(crate) fn assigned(volumes: &[f64], fractions: &[f64]) -> Vec<usize> {
    let mut parts = Apportionment::new(fractions.to_vec(), volumes.iter().sum());
    let mut order: Vec<usize> = (0..volumes.len()).collect();
    order.sort_by(|a, b| volumes[*b].total_cmp(&volumes[*a]));
    let mut is_empty = vec![true; fractions.len()];
    let mut phase_of = vec![0; volumes.len()];
    for (place, grain) in order.into_iter().enumerate() {
        let empty = is_empty.iter().filter(|is_empty| **is_empty).count();
        let are_for_empty = volumes.len() - place <= empty;
        let may = (0..fractions.len()).filter(|phase| !are_for_empty || is_empty[*phase]);
        let phase = parts.give(volumes[grain], may).unwrap_or(0);
        phase_of[grain] = phase;
        is_empty[phase] = false;
    }
    phase_of
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Phases once lacked absolutely: then 0.2 of the volume had a mean diameter of 0.78 of the other's.
    #[test]
    fn phases_of_one_distribution_have_grains_alike_in_size() {
        let diameters: Vec<f64> = (0..400).map(|place| 0.5 + f64::from(place) / 400.0).collect();
        let volumes: Vec<f64> = diameters.iter().map(|diameter| diameter.powi(3)).collect();
        for fractions in [vec![0.8, 0.2], vec![0.5, 0.3, 0.2], vec![0.98, 0.02]] {
            let phase_of = assigned(&volumes, &fractions);
            let total: f64 = volumes.iter().sum();
            for (phase, fraction) in fractions.iter().enumerate() {
                let own: Vec<usize> = (0..400).filter(|grain| phase_of[*grain] == phase).collect();
                let mean = own.iter().map(|grain| diameters[*grain]).sum::<f64>() / own.len() as f64;
                assert!((mean - 1.0).abs() < 0.05, "{fractions:?}: {mean}");
                let volume = own.iter().map(|grain| volumes[*grain]).sum::<f64>() / total;
                assert!((volume / fraction - 1.0).abs() < 0.06, "{fractions:?}: {volume}");
            }
        }
    }

    #[test]
    fn each_phase_has_a_grain() {
        assert_eq!(assigned(&[5.0, 1.0, 4.0], &[0.999, 0.0005, 0.0005]), [0, 2, 1]);
    }
}
