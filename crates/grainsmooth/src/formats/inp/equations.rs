//! Equations that tie nodes a period apart.
//!
//! A node and the one it stands for, s periods away along each axis, move alike but for the stretch of the box: u - u' - sum s_a u_a = 0, where u_a is the displacement of a node of its own for
//! axis a. With a mean deformation gradient F that is (F - 1) times the side of the box. Every copy is the first node of one equation and stands in no other, so that no chains arise at the
//! edges and corners of the box.

use std::io::{self, Write};

use glam::DVec3;
use voronoi::PeriodicPair;

use super::elements::write_node;
use crate::Polycrystal;
use crate::names::AXES;

/// Whether equations are asked for, or needed by what is.
pub(super) fn are_asked(polycrystal: &Polycrystal) -> bool {
    let volume = polycrystal.file().volume;
    let is_periodic = polycrystal.network.domain().is_periodic();
    volume.periodic_equations || (is_periodic && (volume.solver_deck.is_some() || volume.cohesive))
}

/// Writes the nodes of the axes as sets `PERIOD_X` and so on, one node that may be held as the set `HELD`, and the equations between pairs of nodes.
pub(super) fn write(
    polycrystal: &Polycrystal,
    node_count: usize,
    pairs: &[PeriodicPair<u32>],
    out: &mut dyn Write,
) -> io::Result<()> {
    let domain = polycrystal.network.domain();
    let axes = if domain.is_periodic() { domain.periodic() } else { polycrystal.axes_cut_at_box() };
    let axis_count = usize::from(polycrystal.dimension().axes());
    let mut of_axes = [0; 3];
    let periodic = (0..axis_count).filter(|axis| axes.test(*axis));
    for (node, axis) in (node_count + 1..).zip(periodic) {
        of_axes[axis] = node;
        writeln!(out, "*NODE, NSET=PERIOD_{}", AXES[axis].to_uppercase())?;
        write_node(node, domain.lower() + DVec3::AXES[axis] * domain.size(), out)?;
    }
    let mut is_copy = vec![false; node_count];
    pairs.iter().for_each(|pair| is_copy[pair.secondary as usize] = true);
    if let Some(held) = is_copy.iter().rposition(|is_copy| !is_copy) {
        writeln!(out, "*NSET, NSET=HELD\n{},", held + 1)?;
    }
    writeln!(out, "*EQUATION")?;
    for PeriodicPair { secondary, primary, translation } in pairs {
        let translations = of_axes.into_iter().zip(translation.0).filter(|(_, periods)| *periods != 0);
        let of_axes: Vec<(usize, i8)> = translations.map(|(node, periods)| (node, -periods)).collect();
        let ends = [(*secondary as usize + 1, 1), (*primary as usize + 1, -1)];
        for component in 1..=axis_count {
            let terms = ends.iter().chain(&of_axes);
            let terms: Vec<String> =
                terms.map(|(node, factor)| format!("{node}, {component}, {factor}.")).collect();
            writeln!(out, "{}", terms.len())?;
            // Both programs read four terms a line.
            terms.chunks(4).try_for_each(|line| writeln!(out, "{}", line.join(", ")))?;
        }
    }
    Ok(())
}
