// Triangles of refined meshes: they follow from those of the base by index arithmetic, so that points alone are sent. The program numbers
// children in the same way. `directed` has, for each side of each triangle, twice its edge, plus 1 if it runs against the edge.
export function refine(triangles, directed, vertices, steps) {
  let edges = 0;
  for (const side of directed) edges = Math.max(edges, (side >>> 1) + 1);
  for (let step = 0; step < steps; step++) {
    const count = triangles.length / 3;
    const finer = new Uint32Array(4 * triangles.length), sides = new Uint32Array(4 * triangles.length);
    for (let t = 0, corner = 0, centre = 9 * count; t < count; t++, corner += 9, centre += 3) {
      const a = triangles[3 * t], b = triangles[3 * t + 1], c = triangles[3 * t + 2];
      const d = directed[3 * t], e = directed[3 * t + 1], f = directed[3 * t + 2];
      const onD = vertices + (d >>> 1), onE = vertices + (e >>> 1), onF = vertices + (f >>> 1);
      finer[corner] = a; finer[corner + 1] = onD; finer[corner + 2] = onF;
      finer[corner + 3] = b; finer[corner + 4] = onE; finer[corner + 5] = onD;
      finer[corner + 6] = c; finer[corner + 7] = onF; finer[corner + 8] = onE;
      finer[centre] = onF; finer[centre + 1] = onD; finer[centre + 2] = onE;
      const inner = 2 * (2 * edges + 3 * t);
      sides[corner] = start(d); sides[corner + 1] = inner; sides[corner + 2] = end(f);
      sides[corner + 3] = start(e); sides[corner + 4] = inner + 2; sides[corner + 5] = end(d);
      sides[corner + 6] = start(f); sides[corner + 7] = inner + 4; sides[corner + 8] = end(e);
      sides[centre] = inner + 1; sides[centre + 1] = inner + 3; sides[centre + 2] = inner + 5;
    }
    [vertices, edges, triangles, directed] = [vertices + edges, 2 * edges + 3 * count, finer, sides];
  }
  return { triangles, directed };
}

// The halves of a side where it starts and where it ends.
function start(side) {
  return 2 * side + (side & 1);
}

function end(side) {
  return 2 * (side ^ 1) + (side & 1);
}

// The ends of each edge, from the side that runs along it.
export function edgesOf({ triangles, directed }) {
  const ends = new Uint32Array(2 * triangles.length);
  let place = 0;
  for (let side = 0; side < triangles.length; side++) {
    if (directed[side] & 1) continue;
    ends[place++] = triangles[side];
    ends[place++] = triangles[side % 3 === 2 ? side - 2 : side + 1];
  }
  return ends.slice(0, place);
}

// Normals at points, by the areas of the triangles around them.
export function normalsOf(points, triangles) {
  const normals = new Float32Array(points.length);
  for (let corner = 0; corner < triangles.length; corner += 3) {
    const a = 3 * triangles[corner], b = 3 * triangles[corner + 1], c = 3 * triangles[corner + 2];
    const ux = points[b] - points[a], uy = points[b + 1] - points[a + 1], uz = points[b + 2] - points[a + 2];
    const vx = points[c] - points[a], vy = points[c + 1] - points[a + 1], vz = points[c + 2] - points[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    normals[a] += x; normals[a + 1] += y; normals[a + 2] += z;
    normals[b] += x; normals[b + 1] += y; normals[b + 2] += z;
    normals[c] += x; normals[c + 1] += y; normals[c + 2] += z;
  }
  for (let point = 0; point < normals.length; point += 3) {
    const length = Math.sqrt(normals[point] ** 2 + normals[point + 1] ** 2 + normals[point + 2] ** 2) || 1;
    for (let axis = 0; axis < 3; axis++) normals[point + axis] /= length;
  }
  return normals;
}
