//! The stencil of an old vertex, for every scheme that moves vertices: sharp rules, and what lies between sharp and smooth.

use crate::sharpness::{OutgoingEdge, Sharpness, decay, is_infinite, rule_of_sharp_edges};
use crate::{EdgeId, VertexRule};

/// Hands the stencil of `vertex` to `add`, entry by entry: by its sharp rule, by `smooth`, which is given its scale of the row, or
/// by a blend of the rule and the next level's when some sharpness runs out (OpenSubdiv's rule). A blend may name
/// a vertex more than once.
pub(crate) fn vertex_stencil<Add: FnMut(u32, f64)>(
    sharpness: &Sharpness,
    (vertex, rule): (u32, VertexRule),
    add: &mut Add,
    other_end: impl Fn(EdgeId) -> u32,
    smooth: impl Fn(f64, &mut Add),
) {
    if matches!(rule, VertexRule::Smooth | VertexRule::Dart) {
        return smooth(1.0, add);
    }
    let outgoing_edges = sharpness.outgoing_edges(vertex);
    let corner = sharpness.of_corner(vertex);
    let next_rule = rule_after(outgoing_edges, corner);
    let sharp_share = if next_rule == rule { 1.0 } else { share_before_run_out(outgoing_edges, corner) };
    let sharp_row = |rule: VertexRule,
                     outgoing_edges: &mut dyn Iterator<Item = &OutgoingEdge>,
                     scale: f64,
                     add: &mut Add| {
        if rule == VertexRule::Crease {
            add(vertex, 0.75 * scale);
            outgoing_edges.for_each(|outgoing_edge| add(other_end(outgoing_edge.edge), 0.125 * scale));
        } else {
            add(vertex, scale);
        }
    };
    sharp_row(rule, &mut outgoing_edges.iter(), sharp_share, add);
    if sharp_share < 1.0 {
        let rest = 1.0 - sharp_share;
        match next_rule {
            VertexRule::Smooth | VertexRule::Dart => smooth(rest, add),
            _ => sharp_row(next_rule, &mut still_sharp(outgoing_edges), rest, add),
        }
    }
}

/// The outgoing edges that are sharp one level on.
fn still_sharp(outgoing_edges: &[OutgoingEdge]) -> impl Iterator<Item = &OutgoingEdge> {
    outgoing_edges.iter().filter(|outgoing_edge| decay(outgoing_edge.sharpness) > 0.0)
}

/// The rule of a vertex one level on.
fn rule_after(outgoing_edges: &[OutgoingEdge], corner: f32) -> VertexRule {
    if decay(corner) > 0.0 {
        VertexRule::Corner
    } else {
        rule_of_sharp_edges(still_sharp(outgoing_edges).count())
    }
}

/// The mean of the sharpnesses that run out in this step, at most 1: the scale of the rule that held until now. In single
/// precision and the vertex's own first, as in OpenSubdiv, so that numbers agree to the last digits.
fn share_before_run_out(outgoing_edges: &[OutgoingEdge], corner: f32) -> f64 {
    let ending = |&sharpness: &f32| sharpness > 0.0 && !is_infinite(sharpness) && decay(sharpness) == 0.0;
    let sharpnesses = [corner]
        .into_iter()
        .chain(outgoing_edges.iter().map(|outgoing_edge| outgoing_edge.sharpness))
        .filter(ending);
    let (sum, count) = sharpnesses.fold((0.0, 0.0), |(sum, count), s| (sum + s, count + 1.0));
    if count > 0.0 { f64::from(f32::min(sum / count, 1.0)) } else { 1.0 }
}
