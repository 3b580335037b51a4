//! Tables of grains, boundaries, triple lines and quadruple points in space.

use std::collections::BTreeMap;

use polycrystal::{
    BoundaryMeasures, GrainMeasures, QuadruplePointMeasures, SpaceMeasures, TripleLineMeasures,
};

use super::{Tables, add_angles, count, distributions, grain_count, id, ids, is_inside, side, sides};
use crate::names::SEED_ID;
use crate::tables::table::Table;
use crate::tables::table::Value::{self, Number};

pub(super) fn tables(measures: &SpaceMeasures, seed_ids: &[u32], grain_counts: &[u8]) -> Tables {
    let SpaceMeasures { grains, boundaries, triple_lines, quadruple_points, .. } = measures;
    let boundaries_inside = boundaries.iter().filter(|boundary| is_inside(&boundary.sides));
    let lines_inside = triple_lines.iter().filter(|line| is_inside(&line.sides));
    let areas = boundaries_inside.clone().map(|boundary| boundary.area);
    let mut distributions = distributions([
        ("volume", grains.iter().map(|grain| grain.volume).collect()),
        ("area", grains.iter().map(|grain| grain.area).collect()),
        ("equivalent_diameter", grains.iter().map(|grain| grain.equivalent_diameter).collect()),
        ("sphericity", grains.iter().map(|grain| grain.sphericity).collect()),
        ("mean_width", grains.iter().map(|grain| grain.mean_width).collect()),
        ("neighbors", grains.iter().map(|grain| grain.neighbors.len() as f64).collect()),
        ("faces", grains.iter().map(|grain| grain.face_count as f64).collect()),
        ("boundary_area", areas.collect()),
        ("edges_per_face", boundaries_inside.map(|boundary| boundary.edge_count as f64).collect()),
        ("triple_line_length", lines_inside.map(|line| line.length).collect()),
    ]);
    add_angles(&mut distributions, measures.dihedral_angles, |range| {
        let lines = triple_lines.iter().filter(|line| is_inside(&line.sides) && line.sides.len() == 3);
        for line in lines.clone() {
            *range = [range[0].min(line.smallest_angle), range[1].max(line.largest_angle)];
        }
        3 * lines.count()
    });
    let others = [
        ("boundaries", boundary_table(boundaries)),
        ("triple_lines", triple_line_table(triple_lines)),
        ("quadruple_points", quadruple_point_table(quadruple_points, grain_counts)),
    ];
    (grain_table(grains, seed_ids), BTreeMap::from(others), distributions)
}

fn grain_table(grains: &[GrainMeasures], seed_ids: &[u32]) -> Table {
    Table::new(
        grains,
        &[
            ("id", &|grain| id(grain.grain.0)),
            ("volume", &|grain| Number(grain.volume)),
            ("area", &|grain| Number(grain.area)),
            ("centroid_x", &|grain| Number(grain.centroid.x)),
            ("centroid_y", &|grain| Number(grain.centroid.y)),
            ("centroid_z", &|grain| Number(grain.centroid.z)),
            ("equivalent_diameter", &|grain| Number(grain.equivalent_diameter)),
            ("sphericity", &|grain| Number(grain.sphericity)),
            ("mean_width", &|grain| Number(grain.mean_width)),
            ("integral_mean_curvature", &|grain| Number(grain.integral_mean_curvature)),
            ("triple_line_length", &|grain| Number(grain.triple_line_length)),
            ("growth_rate", &|grain| Number(grain.growth_rate.unwrap_or(f64::NAN))),
            ("curvature_rate", &|grain| Number(grain.curvature_rate)),
            ("faces", &|grain| count(grain.face_count)),
            ("edges", &|grain| count(grain.edge_count)),
            ("vertices", &|grain| count(grain.vertex_count)),
            ("edges_per_face", &|grain| Number(grain.edges_per_face)),
            ("inertia_xx", &|grain| Number(grain.inertia.x_axis.x)),
            ("inertia_yy", &|grain| Number(grain.inertia.y_axis.y)),
            ("inertia_zz", &|grain| Number(grain.inertia.z_axis.z)),
            ("inertia_xy", &|grain| Number(grain.inertia.x_axis.y)),
            ("inertia_xz", &|grain| Number(grain.inertia.x_axis.z)),
            ("inertia_yz", &|grain| Number(grain.inertia.y_axis.z)),
            ("at_exterior", &|grain| Value::Flag(grain.is_at_exterior)),
            ("neighbors", &|grain| ids(grain.neighbors.iter().map(|neighbor| neighbor.0))),
            (SEED_ID, &|grain| id(seed_ids[grain.grain.index()])),
        ],
    )
}

fn boundary_table(boundaries: &[BoundaryMeasures]) -> Table {
    Table::new(
        boundaries,
        &[
            ("id", &|boundary| id(boundary.boundary.0)),
            ("side_0", &|boundary| side(boundary.sides[0])),
            ("side_1", &|boundary| side(boundary.sides[1])),
            ("area", &|boundary| Number(boundary.area)),
            ("centroid_x", &|boundary| Number(boundary.centroid.x)),
            ("centroid_y", &|boundary| Number(boundary.centroid.y)),
            ("centroid_z", &|boundary| Number(boundary.centroid.z)),
            ("normal_x", &|boundary| Number(boundary.mean_normal.x)),
            ("normal_y", &|boundary| Number(boundary.mean_normal.y)),
            ("normal_z", &|boundary| Number(boundary.mean_normal.z)),
            ("edges", &|boundary| count(boundary.edge_count)),
            ("perimeter", &|boundary| Number(boundary.perimeter)),
            ("mean_curvature", &|boundary| Number(boundary.mean_curvature)),
        ],
    )
}

fn triple_line_table(lines: &[TripleLineMeasures]) -> Table {
    let lines: Vec<(usize, &TripleLineMeasures)> = lines.iter().enumerate().collect();
    Table::new(
        &lines,
        &[
            ("id", &|(id, _)| count(*id)),
            ("length", &|(_, line)| Number(line.length)),
            ("smallest_angle", &|(_, line)| Number(line.smallest_angle)),
            ("largest_angle", &|(_, line)| Number(line.largest_angle)),
            ("residual", &|(_, line)| Number(line.residual.unwrap_or(f64::NAN))),
            ("closed", &|(_, line)| Value::Flag(line.is_closed)),
            ("grains", &|(_, line)| grain_count(&line.sides)),
            ("sides", &|(_, line)| sides(&line.sides)),
            ("mean_angles", &|(_, line)| Value::Numbers(line.mean_angles.clone())),
            ("boundaries", &|(_, line)| ids(line.boundaries.iter().map(|boundary| boundary.0))),
        ],
    )
}

/// `grain_counts` are those of all points.
fn quadruple_point_table(points: &[QuadruplePointMeasures], grain_counts: &[u8]) -> Table {
    Table::new(
        points,
        &[
            ("point", &|at| id(at.point)),
            ("x", &|at| Number(at.position.x)),
            ("y", &|at| Number(at.position.y)),
            ("z", &|at| Number(at.position.z)),
            ("lines", &|at| count(at.line_count)),
            ("grains", &|at| count(grain_counts[at.point as usize].into())),
            ("mean_angle", &|at| Number(at.mean_angle)),
            ("smallest_angle", &|at| Number(at.smallest_angle)),
            ("largest_angle", &|at| Number(at.largest_angle)),
            ("sides", &|at| sides(&at.sides)),
        ],
    )
}
