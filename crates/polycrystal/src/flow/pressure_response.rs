//! How unknowns that resist one by one give way to the pressures of grains.

use glam::DVec3;
use rayon::prelude::*;

use crate::flow::volume_constraint::{Compliance, VolumeConstraint};
use crate::solver::conjugate_gradients::SOLVED;
use crate::{Freedom, GrainId};

/// Unknowns that one task works on; fixed, so that no sum depends on the number of threads.
pub(crate) const CHUNK: usize = 4096;

/// Unknown displacements, how much each resists, and how volumes follow.
pub(crate) struct PressureResponse {
    /// The displacement under a force of one; 0 where nothing resists.
    pub(crate) mobility: Vec<f64>,
    /// The unknowns that walls hold, and what they leave to them.
    held: Vec<(usize, Freedom)>,
    pub(crate) constraint: Option<(VolumeConstraint, Compliance)>,
}

impl PressureResponse {
    /// That of unknowns that resist so much; without a constraint volumes are free.
    pub(crate) fn new(resistance: &[f64], freedoms: &[Freedom], volumes: Option<VolumeConstraint>) -> Self {
        let one_over = |resistance: &f64| if *resistance > 0.0 { 1.0 / resistance } else { 0.0 };
        let mobility: Vec<f64> = resistance.par_iter().with_min_len(CHUNK).map(one_over).collect();
        let constraint = volumes.map(|constraint| {
            let compliance = constraint.compliance(&mobility);
            (constraint, compliance)
        });
        let freedoms = freedoms.par_iter().copied().enumerate().with_min_len(CHUNK);
        let held = freedoms.filter(|(_, freedom)| *freedom != Freedom::Everywhere).collect();
        Self { mobility, held, constraint }
    }

    /// The displacement under the pressures that change the volumes of the network's grains by `changes`, to first order: the least one, by
    /// resistance. None where volumes are free.
    pub(crate) fn displacement(&self, changes: &[f64]) -> Vec<DVec3> {
        let Some((constraint, compliance)) = &self.constraint else {
            return vec![DVec3::ZERO; self.mobility.len()];
        };
        let pressures = compliance.pressures(&constraint.in_order(changes), SOLVED);
        let force = |unknown: usize| constraint.force(&pressures, unknown) * self.mobility[unknown];
        let mut moves: Vec<DVec3> =
            (0..self.mobility.len()).into_par_iter().with_min_len(CHUNK).map(force).collect();
        self.hold(&mut moves);
        moves
    }

    /// Whether there are pressures that change the volume of a grain.
    pub(crate) fn can_change(&self, grain: GrainId) -> bool {
        let constraint = self.constraint.as_ref();
        constraint.is_some_and(|(constraint, compliance)| compliance.gives_way(constraint.place(grain)))
    }

    /// Takes out what walls hold.
    pub(crate) fn hold(&self, vector: &mut [DVec3]) {
        self.held.iter().for_each(|(unknown, freedom)| vector[*unknown] = freedom.project(vector[*unknown]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Groups that come to grains in another order than that of their numbers, three of them to one grain alone.
    #[test]
    fn changes_are_those_of_the_grains_that_have_these_numbers() {
        let grains_of_groups: [&[(u32, DVec3)]; 5] = [
            &[(3, DVec3::X), (1, DVec3::NEG_X)],
            &[(3, DVec3::Y)],
            &[(1, DVec3::Z)],
            &[(0, DVec3::X), (3, DVec3::NEG_X)],
            &[(0, DVec3::new(0.0, 2.0, 1.0))],
        ];
        let freedoms = [Freedom::Everywhere; 5];
        let by_group = VolumeConstraint::by_group(&freedoms, 1e-16, |group, gradients| {
            grains_of_groups[group]
                .iter()
                .for_each(|(grain, gradient)| gradients.add(GrainId(*grain), *gradient));
        });
        let constraint = VolumeConstraint::new(by_group, 4);
        let response = PressureResponse::new(&[1.0, 2.0, 0.5, 3.0, 1.0], &freedoms, Some(constraint));
        let wanted = [0.3, -0.2, 0.0, 0.7];
        let moves = response.displacement(&wanted);
        let mut changes = [0.0; 4];
        for (grains, by) in grains_of_groups.iter().zip(&moves) {
            grains.iter().for_each(|(grain, gradient)| changes[*grain as usize] += gradient.dot(*by));
        }
        let largest_error = wanted.iter().zip(changes).map(|(wanted, change)| (wanted - change).abs());
        assert!(largest_error.fold(0.0, f64::max) < 1e-5, "{changes:?}");
        // Grain 2 has no group.
        let can_change = [0, 1, 2, 3].map(|grain| response.can_change(GrainId(grain)));
        assert_eq!(can_change, [true, true, false, true]);
    }
}
