//! Tables of grains, boundaries and triple points in the plane.

use std::collections::BTreeMap;

use polycrystal::{PlaneBoundaryMeasures, PlaneGrainMeasures, PlaneMeasures, TriplePointMeasures};

use super::{Tables, add_angles, count, distributions, grain_count, id, ids, is_inside, side, sides};
use crate::names::SEED_ID;
use crate::tables::table::Table;
use crate::tables::table::Value::{self, Number};

pub(super) fn tables(measures: &PlaneMeasures, seed_ids: &[u32]) -> Tables {
    let PlaneMeasures { grains, boundaries, triple_points, .. } = measures;
    let inside = boundaries.iter().filter(|boundary| is_inside(&boundary.sides));
    let mut distributions = distributions([
        ("area", grains.iter().map(|grain| grain.area).collect()),
        ("perimeter", grains.iter().map(|grain| grain.perimeter).collect()),
        ("equivalent_diameter", grains.iter().map(|grain| grain.equivalent_diameter).collect()),
        ("circularity", grains.iter().map(|grain| grain.circularity).collect()),
        ("neighbors", grains.iter().map(|grain| grain.neighbors.len() as f64).collect()),
        ("sides", grains.iter().map(|grain| grain.side_count as f64).collect()),
        ("boundary_length", inside.map(|boundary| boundary.length).collect()),
    ]);
    add_angles(&mut distributions, measures.dihedral_angles, |range| {
        let inside = triple_points.iter().filter(|point| is_inside(&point.sides) && point.sides.len() == 3);
        let angles: Vec<f64> = inside.flat_map(|point| point.angles.iter().copied()).collect();
        *range = angles.iter().fold(*range, |range, angle| [range[0].min(*angle), range[1].max(*angle)]);
        angles.len()
    });
    let others =
        [("boundaries", boundary_table(boundaries)), ("triple_points", triple_point_table(triple_points))];
    (grain_table(grains, seed_ids), BTreeMap::from(others), distributions)
}

fn grain_table(grains: &[PlaneGrainMeasures], seed_ids: &[u32]) -> Table {
    Table::new(
        grains,
        &[
            ("id", &|grain| id(grain.grain.0)),
            ("area", &|grain| Number(grain.area)),
            ("perimeter", &|grain| Number(grain.perimeter)),
            ("centroid_x", &|grain| Number(grain.centroid.x)),
            ("centroid_y", &|grain| Number(grain.centroid.y)),
            ("equivalent_diameter", &|grain| Number(grain.equivalent_diameter)),
            ("circularity", &|grain| Number(grain.circularity)),
            ("turning", &|grain| Number(grain.turning)),
            ("growth_rate", &|grain| Number(grain.growth_rate.unwrap_or(f64::NAN))),
            ("curvature_rate", &|grain| Number(grain.curvature_rate)),
            ("sides", &|grain| count(grain.side_count)),
            ("moment_xx", &|grain| Number(grain.second_moment.x_axis.x)),
            ("moment_yy", &|grain| Number(grain.second_moment.y_axis.y)),
            ("moment_xy", &|grain| Number(grain.second_moment.x_axis.y)),
            ("at_exterior", &|grain| Value::Flag(grain.is_at_exterior)),
            ("neighbors", &|grain| ids(grain.neighbors.iter().map(|neighbor| neighbor.0))),
            (SEED_ID, &|grain| id(seed_ids[grain.grain.index()])),
        ],
    )
}

fn boundary_table(boundaries: &[PlaneBoundaryMeasures]) -> Table {
    Table::new(
        boundaries,
        &[
            ("id", &|boundary| id(boundary.boundary.0)),
            ("side_0", &|boundary| side(boundary.sides[0])),
            ("side_1", &|boundary| side(boundary.sides[1])),
            ("length", &|boundary| Number(boundary.length)),
            ("centroid_x", &|boundary| Number(boundary.centroid.x)),
            ("centroid_y", &|boundary| Number(boundary.centroid.y)),
            ("normal_x", &|boundary| Number(boundary.mean_normal.x)),
            ("normal_y", &|boundary| Number(boundary.mean_normal.y)),
            ("mean_curvature", &|boundary| Number(boundary.mean_curvature)),
        ],
    )
}

fn triple_point_table(points: &[TriplePointMeasures]) -> Table {
    Table::new(
        points,
        &[
            ("point", &|at| id(at.point)),
            ("x", &|at| Number(at.position.x)),
            ("y", &|at| Number(at.position.y)),
            ("grains", &|at| grain_count(&at.sides)),
            ("sides", &|at| sides(&at.sides)),
            ("angles", &|at| Value::Numbers(at.angles.clone())),
            ("residual", &|at| Number(at.residual.unwrap_or(f64::NAN))),
            ("boundaries", &|at| ids(at.boundaries.iter().map(|boundary| boundary.0))),
        ],
    )
}
