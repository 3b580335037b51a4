//! The row of an old vertex, for every scheme that moves vertices: sharp rules, and what lies between sharp and smooth.

use crate::sharpness::{Sharpness, Spoke, decay, is_infinite, rule_of_sharp_edges};
use crate::{EdgeId, VertexRule};

/// Hands the row of `vertex` to `add`, entry by entry: by its sharp rule, by `smooth`, which is given its share of the row, or
/// by a blend of the rule and the next level's when some sharpness runs out (OpenSubdiv's rule). A blend may name
/// a vertex more than once.
pub(crate) fn vertex_row<Add: FnMut(u32, f64)>(
    sharpness: &Sharpness,
    (vertex, rule): (u32, VertexRule),
    add: &mut Add,
    other_end: impl Fn(EdgeId) -> u32,
    smooth: impl Fn(f64, &mut Add),
) {
    if matches!(rule, VertexRule::Smooth | VertexRule::Dart) {
        return smooth(1.0, add);
    }
    let spokes = sharpness.spokes(vertex);
    let corner = sharpness.of_corner(vertex);
    let next_rule = rule_after(spokes, corner);
    let sharp_share = if next_rule == rule { 1.0 } else { share_before_run_out(spokes, corner) };
    let sharp_row =
        |rule: VertexRule, spokes: &mut dyn Iterator<Item = &Spoke>, share: f64, add: &mut Add| {
            if rule == VertexRule::Crease {
                add(vertex, 0.75 * share);
                spokes.for_each(|spoke| add(other_end(spoke.edge), 0.125 * share));
            } else {
                add(vertex, share);
            }
        };
    sharp_row(rule, &mut spokes.iter(), sharp_share, add);
    if sharp_share < 1.0 {
        let rest = 1.0 - sharp_share;
        match next_rule {
            VertexRule::Smooth | VertexRule::Dart => smooth(rest, add),
            _ => sharp_row(next_rule, &mut still_sharp(spokes), rest, add),
        }
    }
}

/// The spokes that are sharp one level on.
fn still_sharp(spokes: &[Spoke]) -> impl Iterator<Item = &Spoke> {
    spokes.iter().filter(|spoke| decay(spoke.sharpness) > 0.0)
}

/// The rule of a vertex one level on.
fn rule_after(spokes: &[Spoke], corner: f32) -> VertexRule {
    if decay(corner) > 0.0 { VertexRule::Corner } else { rule_of_sharp_edges(still_sharp(spokes).count()) }
}

/// The mean of the sharpnesses that run out in this step, at most 1: the share of the rule that held until now. In single
/// precision and the vertex's own first, as in OpenSubdiv, so that numbers agree to the last digits.
fn share_before_run_out(spokes: &[Spoke], corner: f32) -> f64 {
    let ending = |&sharpness: &f32| sharpness > 0.0 && !is_infinite(sharpness) && decay(sharpness) == 0.0;
    let sharpnesses = [corner].into_iter().chain(spokes.iter().map(|spoke| spoke.sharpness)).filter(ending);
    let (sum, count) = sharpnesses.fold((0.0, 0.0), |(sum, count), s| (sum + s, count + 1.0));
    if count > 0.0 { f64::from(f32::min(sum / count, 1.0)) } else { 1.0 }
}
