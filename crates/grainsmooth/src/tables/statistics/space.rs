//! Tables of grains, boundaries, triple lines and quadruple points in space.

use std::collections::BTreeMap;

use polycrystal::{
    BoundaryMeasures, GrainMeasures, QuadruplePointMeasures, SpaceMeasures, TripleLineMeasures,
};

use super::{
    Tables, add_angles, count, distributions, grain_count, id, ids, is_inside, numbers, side, sides,
};
use crate::tables::table::{Table, Value};

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
    let row = |grain: &GrainMeasures| {
        let [x, y, z] = [grain.inertia.x_axis, grain.inertia.y_axis, grain.inertia.z_axis];
        let mut row = vec![id(grain.grain.0)];
        row.extend(numbers([grain.volume, grain.area]));
        row.extend(numbers(grain.centroid.to_array()));
        row.extend(numbers([grain.equivalent_diameter, grain.sphericity]));
        row.extend(numbers([grain.mean_width, grain.integral_mean_curvature, grain.triple_line_length]));
        row.extend(numbers([grain.growth_rate.unwrap_or(f64::NAN), grain.curvature_rate]));
        row.extend([grain.face_count, grain.edge_count, grain.vertex_count].map(count));
        row.push(Value::Number(grain.edges_per_face));
        row.extend(numbers([x.x, y.y, z.z, x.y, x.z, y.z]));
        row.push(Value::Flag(grain.is_at_exterior));
        row.push(ids(grain.neighbors.iter().map(|neighbor| neighbor.0)));
        row.push(id(seed_ids[grain.grain.index()]));
        row
    };
    let columns = vec![
        "id",
        "volume",
        "area",
        "centroid_x",
        "centroid_y",
        "centroid_z",
        "equivalent_diameter",
        "sphericity",
        "mean_width",
        "integral_mean_curvature",
        "triple_line_length",
        "growth_rate",
        "curvature_rate",
        "faces",
        "edges",
        "vertices",
        "edges_per_face",
        "inertia_xx",
        "inertia_yy",
        "inertia_zz",
        "inertia_xy",
        "inertia_xz",
        "inertia_yz",
        "at_exterior",
        "neighbors",
        "SeedId",
    ];
    Table { columns, rows: grains.iter().map(row).collect() }
}

fn boundary_table(boundaries: &[BoundaryMeasures]) -> Table {
    let row = |boundary: &BoundaryMeasures| {
        let mut row = vec![Value::Integer(i64::from(boundary.boundary.0))];
        row.extend(boundary.sides.map(|of| Value::Integer(side(&of))));
        row.push(Value::Number(boundary.area));
        row.extend(numbers(boundary.centroid.to_array()));
        row.extend(numbers(boundary.mean_normal.to_array()));
        row.extend([count(boundary.edge_count), Value::Number(boundary.perimeter)]);
        row.push(Value::Number(boundary.mean_curvature));
        row
    };
    let columns = vec![
        "id",
        "side_0",
        "side_1",
        "area",
        "centroid_x",
        "centroid_y",
        "centroid_z",
        "normal_x",
        "normal_y",
        "normal_z",
        "edges",
        "perimeter",
        "mean_curvature",
    ];
    Table { columns, rows: boundaries.iter().map(row).collect() }
}

fn triple_line_table(lines: &[TripleLineMeasures]) -> Table {
    let row = |(id, line): (usize, &TripleLineMeasures)| {
        vec![
            count(id),
            Value::Number(line.length),
            Value::Number(line.smallest_angle),
            Value::Number(line.largest_angle),
            Value::Number(line.residual.unwrap_or(f64::NAN)),
            Value::Flag(line.is_closed),
            grain_count(&line.sides),
            sides(&line.sides),
            Value::Numbers(line.mean_angles.clone()),
            ids(line.boundaries.iter().map(|boundary| boundary.0)),
        ]
    };
    let columns = vec![
        "id",
        "length",
        "smallest_angle",
        "largest_angle",
        "residual",
        "closed",
        "grains",
        "sides",
        "mean_angles",
        "boundaries",
    ];
    Table { columns, rows: lines.iter().enumerate().map(row).collect() }
}

/// `grain_counts` are those of all points.
fn quadruple_point_table(points: &[QuadruplePointMeasures], grain_counts: &[u8]) -> Table {
    let row = |at: &QuadruplePointMeasures| {
        let mut row = vec![Value::Integer(i64::from(at.point))];
        row.extend(numbers(at.position.to_array()));
        row.extend([count(at.line_count), count(grain_counts[at.point as usize].into())]);
        row.extend(numbers([at.mean_angle, at.smallest_angle, at.largest_angle]));
        row.push(sides(&at.sides));
        row
    };
    let columns = vec![
        "point",
        "x",
        "y",
        "z",
        "lines",
        "grains",
        "mean_angle",
        "smallest_angle",
        "largest_angle",
        "sides",
    ];
    Table { columns, rows: points.iter().map(row).collect() }
}
