// Draws a network of grains: one draw call for all boundaries. What each pixel shows follows from its boundary's two grains: where the
// viewer stands in a grain that is shown, the pixel is a cap of a slice; else the grain beyond is seen from outside.

const WIDTH = 1024; // texels in a row of a table

const COMMON = `
precision highp float;
precision highp int;
precision highp sampler2D;
uniform sampler2D sides, grains, centers;
uniform float explode;
uniform bool exploded;
vec4 entry(sampler2D list, int number) { return texelFetch(list, ivec2(number % ${WIDTH}, number / ${WIDTH}), 0); }
`;

const VERTEX = COMMON + `
uniform mat4 modelViewMatrix, projectionMatrix;
uniform float toward;
in vec3 position;
in vec4 normal;
in float boundary;
in float value;
flat out ivec2 pair;
flat out int own;
out vec3 facing, seen, place;
out float number;
void main() {
  vec4 beside = entry(sides, int(boundary));
  pair = ivec2(beside.xy);
  own = exploded ? gl_InstanceID : -1;
  place = position;
  if (exploded) {
    int piece = int(own == 0 ? beside.z : beside.w);
    if (piece >= 0) place += explode * entry(centers, piece).xyz;
  }
  vec4 view = modelViewMatrix * vec4(place, 1.0);
  facing = mat3(modelViewMatrix) * normal.xyz;
  seen = view.xyz;
  number = value;
  // Lines stand a little before their surfaces.
  gl_Position = projectionMatrix * vec4(view.xyz * (1.0 - toward), 1.0);
}`;

const SHOWN = COMMON + `
uniform bool sliced;
uniform vec4 plane;
uniform sampler2D scale;
uniform vec2 bounds;
vec3 painted(float number) {
  float share = bounds.y > bounds.x ? (number - bounds.x) / (bounds.y - bounds.x) : 0.5;
  return isnan(number) ? vec3(0.78, 0.78, 0.82) : texelFetch(scale, ivec2(int(clamp(share, 0.0, 1.0) * 255.0), 0), 0).rgb;
}
flat in ivec2 pair;
flat in int own;
in vec3 facing, seen, place;
in float number;
out vec4 color;
// Colour and, as alpha, whether a grain is shown; nothing of the other side where each grain stands by itself.
vec4 shown(int grain) {
  int mine = own == 0 ? pair.x : pair.y;
  return grain < 0 || (own >= 0 && grain != mine) ? vec4(0.0) : entry(grains, grain);
}
bool away() { return sliced && dot(plane.xyz, place) > plane.w; }
`;

const SURFACE = SHOWN + `
uniform mat4 modelViewMatrix;
uniform bool byValue;
uniform int selected;
float lit(vec3 normal) {
  float lamp = max(dot(normal, normalize(vec3(-0.4, 0.5, 1.0))), 0.0);
  return 0.45 + 0.6 * lamp;
}
void main() {
  if (away()) discard;
  int viewer = gl_FrontFacing ? pair.y : pair.x;
  int beyond = gl_FrontFacing ? pair.x : pair.y;
  vec4 here = shown(viewer), there = shown(beyond);
  bool cap = here.a > 0.5;
  if (!cap && there.a <= 0.5) discard;
  int grain = cap ? viewer : beyond;
  vec3 paint = cap ? here.rgb : there.rgb;
  if (byValue) paint = cap ? vec3(0.78, 0.78, 0.82) : painted(number);
  vec3 normal = normalize(gl_FrontFacing ? facing : -facing);
  float light = cap ? (sliced ? lit(normalize(mat3(modelViewMatrix) * plane.xyz)) : lit(normal)) : lit(normal);
  if (grain == selected) light *= mod(floor((gl_FragCoord.x + gl_FragCoord.y) / 4.0), 2.0) == 0.0 ? 1.0 : 0.7;
  color = vec4(pow(pow(paint, vec3(2.2)) * light, vec3(1.0 / 2.2)), 1.0);
}`;

const LINE = SHOWN + `
uniform bool linesByValue;
void main() {
  if (away()) discard;
  // Of the surface that is seen from outside, not of walls behind it.
  bool front = dot(facing, seen) < 0.0;
  if (shown(front ? pair.x : pair.y).a <= 0.5 || shown(front ? pair.y : pair.x).a > 0.5) discard;
  color = vec4(linesByValue ? painted(number) : vec3(0.1), 1.0);
}`;

// A list of tuples of four as a texture; what it holds can change.
class Table {
  constructor(count) {
    const rows = Math.max(1, Math.ceil(count / WIDTH));
    this.data = new Float32Array(4 * WIDTH * rows);
    this.texture = new THREE.DataTexture(this.data, WIDTH, rows, THREE.RGBAFormat, THREE.FloatType);
    this.texture.needsUpdate = true;
  }

  set(number, tuple) {
    this.data.set(tuple, 4 * number);
    this.texture.needsUpdate = true;
  }
}

export class Network {
  // `head` and `arrays` as unpacked; `scale` gives the colour of a share.
  constructor({ head, arrays }, scale) {
    this.head = head;
    this.arrays = arrays;
    const { boundaries, ids, centers } = head;
    this.count = ids.length;
    this.sides = new Table(boundaries.length);
    this.grains = new Table(ids.length);
    this.centers = new Table(centers.length);
    this.isShown = new Uint8Array(ids.length).fill(1);
    centers.forEach((center, piece) => this.centers.set(piece, center));
    this.pieceOf = new Int32Array(ids.length);
    const number = new Float32Array(arrays.position.length / 3);
    let vertex = 0, triangle = 0, rim = 0;
    this.parts = boundaries.map(({ sides, pieces, vertices, triangles, rim: edges }, boundary) => {
      this.sides.set(boundary, [...sides, ...pieces]);
      sides.forEach((grain, side) => { this.pieceOf[grain] = pieces[side]; });
      number.fill(boundary, vertex, vertex + vertices);
      const part = { sides, pieces, vertex, vertices, corner: 3 * triangle, corners: 3 * triangles, end: 2 * rim, ends: 2 * edges };
      vertex += vertices;
      triangle += triangles;
      rim += edges;
      return part;
    });
    this.measureBoxes();
    const colors = Float32Array.from({ length: 1024 }, (_, place) => (place % 4 === 3 ? 1 : scale((place >> 2) / 255)[place % 4]));
    const scaleTexture = new THREE.DataTexture(colors, 256, 1, THREE.RGBAFormat, THREE.FloatType);
    scaleTexture.needsUpdate = true;
    this.uniforms = {
      sides: { value: this.sides.texture }, grains: { value: this.grains.texture }, centers: { value: this.centers.texture },
      explode: { value: 0 }, exploded: { value: false }, sliced: { value: false }, plane: { value: [0, 0, 1, 0] },
      byValue: { value: false }, linesByValue: { value: false }, bounds: { value: [0, 1] }, scale: { value: scaleTexture }, selected: { value: -1 },
    };
    this.value = new THREE.BufferAttribute(new Float32Array(number.length), 1);
    const attributes = {
      position: new THREE.BufferAttribute(arrays.position, 3),
      normal: new THREE.BufferAttribute(arrays.normal, 4, true),
      boundary: new THREE.BufferAttribute(number, 1),
      value: this.value,
    };
    const geometry = (count) => {
      const made = new THREE.InstancedBufferGeometry();
      for (const [name, attribute] of Object.entries(attributes)) made.setAttribute(name, attribute);
      made.setIndex(new THREE.BufferAttribute(new Uint32Array(count), 1));
      return made;
    };
    const material = (fragmentShader, toward, more) => new THREE.RawShaderMaterial({
      glslVersion: THREE.GLSL3, vertexShader: VERTEX, fragmentShader, uniforms: { ...this.uniforms, toward: { value: toward } }, side: THREE.DoubleSide, ...more,
    });
    this.surface = new THREE.Mesh(geometry(arrays.corners.length), material(SURFACE, 0));
    this.lines = new THREE.LineSegments(geometry(arrays.rims.length), material(LINE, 0.001));
    this.cutGeometry = new THREE.BufferGeometry();
    this.cut = new THREE.LineSegments(this.cutGeometry, new THREE.LineBasicMaterial({ color: 0x1a1a1a }));
    this.objects = [this.surface, this.lines, this.cut];
    // They stay where they are, and are always in sight.
    for (const object of this.objects) Object.assign(object, { frustumCulled: false, matrixAutoUpdate: false, matrixWorldAutoUpdate: false });
    this.select();
  }

  // The box around each boundary, and around each piece of a grain: low and high corner.
  measureBoxes() {
    const { position } = this.arrays;
    const empty = (count) => Float32Array.from({ length: 6 * count }, (_, place) => (place % 6 < 3 ? Infinity : -Infinity));
    this.boxes = empty(this.head.centers.length);
    this.partBoxes = empty(this.parts.length);
    this.parts.forEach(({ pieces, vertex, vertices }, part) => {
      const box = this.partBoxes.subarray(6 * part, 6 * part + 6);
      for (let place = 3 * vertex; place < 3 * (vertex + vertices); place++) {
        const axis = place % 3;
        if (position[place] < box[axis]) box[axis] = position[place];
        if (position[place] > box[3 + axis]) box[3 + axis] = position[place];
      }
      for (const piece of pieces) {
        if (piece < 0) continue;
        for (let axis = 0; axis < 3; axis++) {
          this.boxes[6 * piece + axis] = Math.min(this.boxes[6 * piece + axis], box[axis]);
          this.boxes[6 * piece + 3 + axis] = Math.max(this.boxes[6 * piece + 3 + axis], box[3 + axis]);
        }
      }
    });
  }

  // By how far a piece of a grain is moved.
  shift(piece, axis) {
    return piece < 0 ? 0 : this.uniforms.explode.value * this.centers.data[4 * piece + axis];
  }

  // Whether the plane of a slice goes through the box of a piece.
  isCut(piece) {
    const { plane: { value: plane } } = this.uniforms;
    let low = 0, high = 0;
    for (let axis = 0; axis < 3; axis++) {
      const shift = this.shift(piece, axis);
      const one = plane[axis] * (this.boxes[6 * piece + axis] + shift), other = plane[axis] * (this.boxes[6 * piece + 3 + axis] + shift);
      low += Math.min(one, other);
      high += Math.max(one, other);
    }
    return low <= plane[3] && plane[3] <= high;
  }

  // Chooses what can be seen: boundaries with one side shown, and all of grains that are cut or stand by themselves.
  select() {
    const { sliced: { value: sliced }, exploded: { value: exploded } } = this.uniforms;
    const isOpen = Uint8Array.from(this.head.centers, (_, piece) => (sliced && this.isCut(piece) ? 1 : 0));
    const { index: surface } = this.surface.geometry, { index: lines } = this.lines.geometry;
    let corners = 0, ends = 0;
    const cut = [];
    this.chosen = [];
    this.parts.forEach((part, number) => {
      const [a, b] = part.sides;
      const first = a >= 0 && this.isShown[a] === 1, second = b >= 0 && this.isShown[b] === 1;
      const isCut = (first && isOpen[part.pieces[0]] === 1) || (second && isOpen[part.pieces[1]] === 1);
      if (isCut) cut.push(part);
      if (!(first !== second || isCut || (exploded && (first || second)))) return;
      this.chosen.push(number);
      surface.array.set(this.arrays.corners.subarray(part.corner, part.corner + part.corners), corners);
      corners += part.corners;
      lines.array.set(this.arrays.rims.subarray(part.end, part.end + part.ends), ends);
      ends += part.ends;
    });
    for (const [object, count] of [[this.surface, corners], [this.lines, ends]]) {
      object.geometry.instanceCount = exploded ? 2 : 1;
      object.geometry.setDrawRange(0, count);
      object.geometry.index.clearUpdateRanges();
      object.geometry.index.addUpdateRange(0, count);
      object.geometry.index.needsUpdate = true;
    }
    this.triangles = corners / 3;
    this.outlineCut(cut);
  }

  // Lines where the plane goes through boundaries.
  outlineCut(parts) {
    const { position, corners } = this.arrays;
    const [nx, ny, nz, offset] = this.uniforms.plane.value;
    const { exploded: { value: exploded } } = this.uniforms;
    const isSeen = (grain) => grain >= 0 && this.isShown[grain] === 1;
    const found = [];
    for (const { sides, pieces, corner: first, corners: count } of parts) {
      for (let side = exploded ? 0 : -1; side < (exploded ? 2 : 0); side++) {
        if (exploded ? !isSeen(sides[side]) : !isSeen(sides[0]) && !isSeen(sides[1])) continue;
        const piece = exploded ? pieces[side] : -1;
        const sx = this.shift(piece, 0), sy = this.shift(piece, 1), sz = this.shift(piece, 2);
        const level = offset - (nx * sx + ny * sy + nz * sz);
        const height = (point) => nx * position[point] + ny * position[point + 1] + nz * position[point + 2] - level;
        const cross = (a, b, from, to) => {
          if (from > 0 === to > 0) return;
          const t = from / (from - to);
          found.push(
            position[a] + t * (position[b] - position[a]) + sx,
            position[a + 1] + t * (position[b + 1] - position[a + 1]) + sy,
            position[a + 2] + t * (position[b + 2] - position[a + 2]) + sz,
          );
        };
        for (let corner = first; corner < first + count; corner += 3) {
          const a = 3 * corners[corner], b = 3 * corners[corner + 1], c = 3 * corners[corner + 2];
          const d = height(a), e = height(b), f = height(c);
          if (d > 0 === e > 0 && e > 0 === f > 0) continue;
          cross(a, b, d, e);
          cross(b, c, e, f);
          cross(c, a, f, d);
        }
      }
    }
    this.cutGeometry.dispose();
    this.cutGeometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(found), 3));
    this.cut.visible = this.lines.visible && found.length > 0;
  }

  // The grain that is seen along a ray, -1 for none: the nearest of what the shaders show.
  pick({ origin, direction }) {
    const { sliced: { value: sliced }, plane: { value: plane }, exploded: { value: exploded } } = this.uniforms;
    const { position, corners } = this.arrays;
    const [dx, dy, dz] = direction;
    let nearest = Infinity, seen = -1;
    for (const number of this.chosen) {
      const { sides, pieces, corner: first, corners: count } = this.parts[number];
      for (let own = exploded ? 0 : -1; own < (exploded ? 2 : 0); own++) {
        // Where each grain stands by itself, nothing of the other side is shown.
        const isShown = (side) => sides[side] >= 0 && (own < 0 || own === side) && this.isShown[sides[side]] === 1;
        const shown = [isShown(0), isShown(1)];
        if (!shown[0] && !shown[1]) continue;
        const piece = own < 0 ? -1 : pieces[own];
        const ox = origin[0] - this.shift(piece, 0), oy = origin[1] - this.shift(piece, 1), oz = origin[2] - this.shift(piece, 2);
        if (!this.meetsBox(number, [ox, oy, oz], direction, nearest)) continue;
        for (let corner = first; corner < first + count; corner += 3) {
          const a = 3 * corners[corner], b = 3 * corners[corner + 1], c = 3 * corners[corner + 2];
          const ux = position[b] - position[a], uy = position[b + 1] - position[a + 1], uz = position[b + 2] - position[a + 2];
          const vx = position[c] - position[a], vy = position[c + 1] - position[a + 1], vz = position[c + 2] - position[a + 2];
          // Moller and Trumbore 1997.
          const px = dy * vz - dz * vy, py = dz * vx - dx * vz, pz = dx * vy - dy * vx;
          const facing = ux * px + uy * py + uz * pz;
          if (facing === 0) continue;
          const wx = ox - position[a], wy = oy - position[a + 1], wz = oz - position[a + 2];
          const s = (wx * px + wy * py + wz * pz) / facing;
          if (s < 0 || s > 1) continue;
          const qx = wy * uz - wz * uy, qy = wz * ux - wx * uz, qz = wx * uy - wy * ux;
          const t = (dx * qx + dy * qy + dz * qz) / facing;
          if (t < 0 || s + t > 1) continue;
          const distance = (vx * qx + vy * qy + vz * qz) / facing;
          if (distance <= 0 || distance >= nearest) continue;
          if (sliced && plane[0] * (origin[0] + distance * dx) + plane[1] * (origin[1] + distance * dy) + plane[2] * (origin[2] + distance * dz) > plane[3]) continue;
          // Normals point from the first side to the second.
          const viewer = facing > 0 ? 1 : 0;
          if (!shown[viewer] && !shown[1 - viewer]) continue;
          nearest = distance;
          seen = sides[shown[viewer] ? viewer : 1 - viewer];
        }
      }
    }
    return seen;
  }

  // Whether a ray goes through the box of a boundary before it has gone so far.
  meetsBox(part, origin, direction, far) {
    let near = 0;
    for (let axis = 0; axis < 3; axis++) {
      const low = this.partBoxes[6 * part + axis] - origin[axis], high = this.partBoxes[6 * part + 3 + axis] - origin[axis];
      if (direction[axis] === 0) {
        if (low > 0 || high < 0) return false;
        continue;
      }
      const one = low / direction[axis], other = high / direction[axis];
      near = Math.max(near, Math.min(one, other));
      far = Math.min(far, Math.max(one, other));
    }
    return near <= far;
  }

  explode(share) {
    this.uniforms.explode.value = share;
    this.uniforms.exploded.value = share > 0;
    this.select();
  }

  // Shows what lies on one side of a plane, where its first three numbers times a place are at most the last; nothing ends the slice.
  slice(plane) {
    this.uniforms.sliced.value = Boolean(plane);
    if (plane) this.uniforms.plane.value = plane;
    this.select();
  }

  show(isShown) {
    for (let grain = 0; grain < this.count; grain++) {
      this.isShown[grain] = isShown(grain) ? 1 : 0;
      this.grains.data[4 * grain + 3] = this.isShown[grain];
    }
    this.grains.texture.needsUpdate = true;
    this.select();
  }

  // Colours grains, by a function of their place.
  paint(color) {
    for (let grain = 0; grain < this.count; grain++) this.grains.set(grain, [...color(grain), this.isShown[grain]]);
    this.uniforms.byValue.value = this.uniforms.linesByValue.value = false;
  }

  // Colours surfaces, or lines, by a number at each vertex.
  paintValues(values, bounds, onLines) {
    this.value.array.set(values);
    this.value.needsUpdate = true;
    this.uniforms.bounds.value = bounds;
    this.uniforms.byValue.value = !onLines;
    this.uniforms.linesByValue.value = onLines;
  }

  // How far from the middle the grains reach.
  radius() {
    return (this.head.is_plane ? 0.55 : 0.87) * (1 + this.uniforms.explode.value);
  }

  dispose() {
    for (const object of this.objects) {
      object.geometry.dispose();
      object.material.dispose();
      object.removeFromParent();
    }
    for (const table of [this.sides, this.grains, this.centers]) table.texture.dispose();
  }
}
