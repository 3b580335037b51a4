//! Tables of grains, boundaries and triple points in the plane.

use std::collections::BTreeMap;

use polycrystal::{PlaneBoundaryMeasures, PlaneGrainMeasures, PlaneMeasures, TriplePointMeasures};

use super::{
    Tables, add_angles, count, distributions, grain_count, id, ids, is_inside, numbers, side, sides,
};
use crate::tables::table::{Table, Value};

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
    let row = |grain: &PlaneGrainMeasures| {
        let [x, y] = [grain.second_moment.x_axis, grain.second_moment.y_axis];
        let mut row = vec![id(grain.grain.0)];
        row.extend(numbers([grain.area, grain.perimeter]));
        row.extend(numbers(grain.centroid.to_array()));
        row.extend(numbers([grain.equivalent_diameter, grain.circularity, grain.turning]));
        row.extend(numbers([grain.growth_rate.unwrap_or(f64::NAN), grain.curvature_rate]));
        row.push(count(grain.side_count));
        row.extend(numbers([x.x, y.y, x.y]));
        row.push(Value::Flag(grain.is_at_exterior));
        row.push(ids(grain.neighbors.iter().map(|neighbor| neighbor.0)));
        row.push(id(seed_ids[grain.grain.index()]));
        row
    };
    let columns = vec![
        "id",
        "area",
        "perimeter",
        "centroid_x",
        "centroid_y",
        "equivalent_diameter",
        "circularity",
        "turning",
        "growth_rate",
        "curvature_rate",
        "sides",
        "moment_xx",
        "moment_yy",
        "moment_xy",
        "at_exterior",
        "neighbors",
        "SeedId",
    ];
    Table { columns, rows: grains.iter().map(row).collect() }
}

fn boundary_table(boundaries: &[PlaneBoundaryMeasures]) -> Table {
    let row = |boundary: &PlaneBoundaryMeasures| {
        let mut row = vec![Value::Integer(i64::from(boundary.boundary.0))];
        row.extend(boundary.sides.map(|of| Value::Integer(side(&of))));
        row.push(Value::Number(boundary.length));
        row.extend(numbers(boundary.centroid.to_array()));
        row.extend(numbers(boundary.mean_normal.to_array()));
        row.push(Value::Number(boundary.mean_curvature));
        row
    };
    let columns = vec![
        "id",
        "side_0",
        "side_1",
        "length",
        "centroid_x",
        "centroid_y",
        "normal_x",
        "normal_y",
        "mean_curvature",
    ];
    Table { columns, rows: boundaries.iter().map(row).collect() }
}

fn triple_point_table(points: &[TriplePointMeasures]) -> Table {
    let row = |at: &TriplePointMeasures| {
        let mut row = vec![Value::Integer(i64::from(at.point))];
        row.extend(numbers(at.position.to_array()));
        row.push(grain_count(&at.sides));
        row.extend([sides(&at.sides), Value::Numbers(at.angles.clone())]);
        row.push(Value::Number(at.residual.unwrap_or(f64::NAN)));
        row.push(ids(at.boundaries.iter().map(|boundary| boundary.0)));
        row
    };
    let columns = vec!["point", "x", "y", "grains", "sides", "angles", "residual", "boundaries"];
    Table { columns, rows: points.iter().map(row).collect() }
}
