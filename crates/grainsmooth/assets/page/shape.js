// Draws what is edited: points that can be taken hold of, edges and faces between them, and what follows from them.
import { NOTHING, range, scale, share } from "./colors.js";

const FRONT = 0xd9c9a8; // sand
const BACK = 0x8ca8d1; // blue: where a surface is open or winds the wrong way
const LEVELS = [0x1a1a1a, 0xd55e00, 0x009e73, 0x0072b2, 0xcc79a7, 0xe69f00, 0x56b4e9];
const NORMAL = 0.04; // length of a normal, in widths of all

const DOTS = {
  glslVersion: THREE.GLSL3,
  vertexShader: `
precision highp float;
uniform mat4 modelViewMatrix, projectionMatrix;
uniform float size;
in vec3 position;
void main() {
  vec4 view = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * vec4(view.xyz * 0.998, 1.0);
  gl_PointSize = size;
}`,
  fragmentShader: `
precision highp float;
uniform vec3 paint;
out vec4 color;
void main() {
  if (length(gl_PointCoord - 0.5) > 0.5) discard;
  color = vec4(paint, 1.0);
}`,
};

function dots(paint, size) {
  const uniforms = { paint: { value: paint }, size: { value: size * window.devicePixelRatio } };
  return new THREE.Points(new THREE.BufferGeometry(), new THREE.RawShaderMaterial({ ...DOTS, uniforms }));
}

function lines(color) {
  return new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color }));
}

export class Shape {
  constructor(stage) {
    const surface = (side, color) => new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshLambertMaterial({
      color, side, flatShading: true, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    }));
    this.front = surface(THREE.FrontSide, FRONT);
    this.back = surface(THREE.BackSide, BACK);
    this.back.geometry = this.front.geometry;
    this.wires = lines(0x5a5348);
    this.cage = lines(0x1a1a1a);
    this.creases = lines(0xd1481f);
    this.normals = lines(0x2f6fde);
    this.curves = new THREE.Group();
    this.points = dots([0.1, 0.1, 0.1], 7);
    this.corners = dots([0.82, 0.28, 0.12], 11);
    this.tips = dots([0, 0.45, 0.7], 11);
    this.marked = { point: dots([0.18, 0.44, 0.87], 14), edge: lines(0x2f6fde), face: null };
    this.marked.face = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshLambertMaterial({ color: 0x2f6fde, side: THREE.DoubleSide }));
    this.objects = [this.front, this.back, this.wires, this.cage, this.creases, this.normals, this.curves, this.points, this.corners, this.tips, ...Object.values(this.marked)];
    for (const object of this.objects) {
      object.frustumCulled = false;
      stage.scene.add(object);
    }
    // Marks are seen through what they lie on.
    for (const object of Object.values(this.marked)) {
      object.material.depthTest = false;
      object.renderOrder = 1;
    }
    stage.scene.add(new THREE.AmbientLight(0xffffff, 1.6));
    const lamp = new THREE.DirectionalLight(0xffffff, 1.8);
    lamp.position.set(-0.4, 0.5, 1);
    stage.camera.add(lamp);
    this.look = { smooth: false, wires: true, cage: true, points: true, normals: false };
  }

  // Shows an unpacked drawing.
  show({ head, arrays }) {
    this.head = head;
    this.arrays = arrays;
    const points = attribute(arrays.points, 3);
    const places = head.has_surface ? attribute(arrays.surface_points, 3) : points;
    const triangles = head.has_surface ? arrays.surface_triangles : arrays.triangles;
    const surface = fresh(this.front, { position: places, normal: attribute(arrays.normals, 4, true) }, triangles);
    this.back.geometry = surface;
    this.bounds = null;
    if (arrays.values) {
      this.bounds = range(arrays.values);
      const color = new Float32Array(3 * arrays.values.length);
      const paint = new THREE.Color();
      for (let point = 0; point < arrays.values.length; point++) {
        const place = share(arrays.values[point], this.bounds);
        const [red, green, blue] = Number.isNaN(place) ? NOTHING : scale(place);
        paint.setRGB(red, green, blue, "srgb").toArray(color, 3 * point);
      }
      surface.setAttribute("color", attribute(color, 3));
    }
    for (const [mesh, color] of [[this.front, FRONT], [this.back, BACK]]) {
      mesh.material.vertexColors = Boolean(arrays.values);
      mesh.material.color.set(arrays.values ? 0xffffff : color);
      mesh.material.needsUpdate = true;
    }
    fresh(this.wires, { position: places }, head.has_surface ? arrays.surface_edges : arrays.edges);
    fresh(this.cage, { position: points }, arrays.edges);
    fresh(this.points, { position: points });
    fresh(this.creases, { position: points }, Uint32Array.from(head.creases.flatMap(([ends]) => ends)));
    fresh(this.corners, { position: points }, Uint32Array.from(head.corners.map(([point]) => point)));
    this.showCurves();
    this.showNormals();
    this.mark(null);
    this.apply();
  }

  // Polylines by level: curves, and de Casteljau's points down to the last.
  showCurves() {
    for (const line of [...this.curves.children]) {
      line.geometry.dispose();
      line.material.dispose();
      this.curves.remove(line);
    }
    const { line_points: places } = this.arrays;
    const tips = [];
    let first = 0;
    for (const [count, level] of this.head.lines) {
      const own = places.subarray(3 * first, 3 * (first + count));
      first += count;
      if (level > 0) tips.push(...own);
      if (count < 2) continue;
      const line = lines(level === 0 ? 0xb3261e : LEVELS[level % LEVELS.length]);
      line.frustumCulled = false;
      const ends = new Uint32Array(2 * (count - 1)).map((_, place) => (place + 1) >> 1);
      fresh(line, { position: attribute(own, 3) }, ends);
      // What is constructed is seen through the surface.
      line.material.depthTest = level === 0;
      this.curves.add(line);
    }
    this.tips.material.depthTest = false;
    fresh(this.tips, { position: attribute(Float32Array.from(tips), 3) });
  }

  showNormals() {
    const { normals } = this.arrays;
    const places = this.head.has_surface ? this.arrays.surface_points : this.arrays.points;
    const ends = new Float32Array(this.look.normals ? 2 * places.length : 0);
    for (let place = 0; 2 * place < ends.length; place++) {
      const point = Math.floor(place / 3), axis = place % 3;
      ends[6 * point + axis] = places[place];
      ends[6 * point + 3 + axis] = places[place] + (NORMAL * normals[4 * point + axis]) / 127;
    }
    fresh(this.normals, { position: attribute(ends, 3) });
  }

  // How things look, by what is checked.
  apply() {
    const { smooth, wires, cage, points, normals } = this.look;
    for (const mesh of [this.front, this.back]) {
      mesh.visible = this.head.triangle_count > 0;
      if (mesh.material.flatShading === smooth) {
        mesh.material.flatShading = !smooth;
        mesh.material.needsUpdate = true;
      }
    }
    this.wires.visible = wires && this.head.has_surface;
    this.cage.visible = this.head.has_surface ? cage : wires || this.head.model !== "mesh";
    this.points.visible = points;
    this.normals.visible = normals;
  }

  // Where a point is.
  place(point) {
    return this.arrays.points.subarray(3 * point, 3 * point + 3);
  }

  // Marks a point, an edge or a face; nothing marks none.
  mark(picked) {
    for (const [kind, object] of Object.entries(this.marked)) {
      object.visible = Boolean(picked && kind in picked);
      if (!object.visible) continue;
      const corners = [picked[kind]].flat();
      const position = attribute(Float32Array.from(corners.flatMap((corner) => [...this.place(corner)])), 3);
      const normal = attribute(new Float32Array(3 * corners.length).fill(0.577), 3);
      fresh(object, kind === "face" ? { position, normal } : { position });
    }
  }
}

function attribute(array, size, isNormalized = false) {
  return new THREE.BufferAttribute(array, size, isNormalized);
}

// Gives an object a new geometry in place of the old.
function fresh(object, attributes, index) {
  object.geometry.dispose();
  object.geometry = new THREE.BufferGeometry();
  for (const [name, value] of Object.entries(attributes)) object.geometry.setAttribute(name, value);
  if (index) object.geometry.setIndex(new THREE.BufferAttribute(index, 1));
  return object.geometry;
}
