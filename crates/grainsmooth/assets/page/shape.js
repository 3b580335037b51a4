// Draws what is edited: points that can be taken hold of, edges and faces between them, and what follows from them.
import { NOTHING, range, scale, share } from "./colors.js";
import { edgesOf, normalsOf, refine } from "./refine.js";

const FRONT = 0xd9c9a8; // sand
const BACK = 0x8ca8d1; // blue: where a surface is open or winds the wrong way
const LEVELS = [0x1a1a1a, 0xd55e00, 0x009e73, 0x0072b2, 0xcc79a7, 0xe69f00, 0x56b4e9];
const NORMAL = 0.04; // length of a normal, in widths of all
const MOST_WIRES = 500000; // triangles whose edges are drawn: of more they are a black sheet
const MOST_FOLLOWING = 200000; // triangles whose normals follow a point that is held, which takes some 10 ms

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

// Colours the back of a surface in its own colour.
function withBack(material, back) {
  material.onBeforeCompile = (shader) => {
    shader.uniforms.back = back;
    shader.fragmentShader = shader.fragmentShader
      .replace("void main() {", "uniform vec3 back;\nvoid main() {")
      .replace("#include <color_fragment>", "#include <color_fragment>\nif (!gl_FrontFacing) diffuseColor.rgb *= back;");
  };
  return material;
}

export class Shape {
  constructor(stage) {
    this.backPaint = { value: new THREE.Color() };
    const material = new THREE.MeshLambertMaterial({
      side: THREE.DoubleSide, flatShading: true, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    });
    this.surface = new THREE.Mesh(new THREE.BufferGeometry(), withBack(material, this.backPaint));
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
    this.objects = [this.surface, this.wires, this.cage, this.creases, this.normals, this.curves, this.points, this.corners, this.tips, ...Object.values(this.marked)];
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
    this.buffers = {};
  }

  // Shows an unpacked drawing. While a point is held, what takes long follows when it is let go.
  show({ head, arrays, changes }, isHeld = false) {
    this.head = head;
    this.arrays = arrays;
    const buffer = (name, size) => this.buffer(name, size, arrays[name], changes[name]);
    const points = buffer("points", 3), edges = buffer("edges", 1), triangles = buffer("triangles", 1);
    this.places = head.has_surface ? buffer("surface_points", 3) : points;
    this.index = head.has_surface ? this.surfaceIndex(buffer, changes) : triangles;
    fill(this.cage, { position: points }, edges);
    fill(this.points, { position: points });
    fill(this.wires, { position: this.places }, head.has_surface ? this.buffers.surface_edges : edges);
    const marks = JSON.stringify([head.creases, head.corners]);
    if (marks !== this.marks || this.creases.geometry.attributes.position !== points) {
      this.marks = marks;
      fill(this.creases, { position: points }, attribute(Uint32Array.from(head.creases.flatMap(([ends]) => ends)), 1));
      fill(this.corners, { position: points }, attribute(Uint32Array.from(head.corners.map(([point]) => point)), 1));
    }
    if (!isHeld || arrays.values?.length !== this.colors?.count) this.paint();
    this.showCurves();
    const isLate = isHeld && head.triangle_count > MOST_FOLLOWING && this.normalArray?.length === this.places.array.length;
    if (!isLate) this.normalArray = null;
    this.mark(null);
    this.apply();
  }

  // The buffer of an array, of which runs have changed; a new one where it is new.
  buffer(name, size, array, runs) {
    const known = this.buffers[name];
    if (known?.array !== array || !runs) return (this.buffers[name] = attribute(array, size));
    for (const [start, count] of runs) known.addUpdateRange(start, count);
    known.needsUpdate ||= runs.length > 0;
    return known;
  }

  // The triangles of a surface, sent or found; and its edges, as long as they can be told apart.
  surfaceIndex(buffer, changes) {
    const { head: { steps, triangle_count: count }, arrays } = this;
    if (steps === null) {
      buffer("surface_edges", 1);
      return buffer("surface_triangles", 1);
    }
    const isKnown = this.refined?.steps === steps && ["base_triangles", "base_edges"].every((name) => changes[name]?.length === 0);
    if (isKnown) return this.refined.index;
    const mesh = refine(arrays.base_triangles, arrays.base_edges, arrays.points.length / 3, steps);
    this.refined = { steps, index: attribute(mesh.triangles, 1) };
    this.buffers.surface_edges = attribute(count <= MOST_WIRES ? edgesOf(mesh) : new Uint32Array(0), 1);
    return this.refined.index;
  }

  // Colours points by their values.
  paint() {
    const { values } = this.arrays;
    this.bounds = values ? range(values) : null;
    this.colors = null;
    if (values) {
      const color = new Float32Array(3 * values.length);
      const paint = new THREE.Color();
      for (let point = 0; point < values.length; point++) {
        const place = share(values[point], this.bounds);
        const [red, green, blue] = Number.isNaN(place) ? NOTHING : scale(place);
        paint.setRGB(red, green, blue, "srgb").toArray(color, 3 * point);
      }
      this.colors = attribute(color, 3);
    }
    const { material } = this.surface;
    if (material.vertexColors !== Boolean(values)) material.needsUpdate = true;
    material.vertexColors = Boolean(values);
    material.color.set(values ? 0xffffff : FRONT);
    this.backPaint.value.set(values ? 0xffffff : BACK);
    if (values) return;
    for (const channel of ["r", "g", "b"]) this.backPaint.value[channel] /= material.color[channel];
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
      fill(line, { position: attribute(own, 3) }, attribute(ends, 1));
      // What is constructed is seen through the surface.
      line.material.depthTest = level === 0;
      this.curves.add(line);
    }
    this.tips.material.depthTest = false;
    fill(this.tips, { position: attribute(Float32Array.from(tips), 3) });
  }

  // Normals at the points of the surface, found when they are needed.
  get vertexNormals() {
    return (this.normalArray ??= normalsOf(this.places.array, this.index.array));
  }

  showNormals() {
    const places = this.places.array;
    const ends = new Float32Array(2 * places.length);
    for (let place = 0; place < places.length; place++) {
      const start = 6 * Math.floor(place / 3) + (place % 3);
      ends[start] = places[place];
      ends[start + 3] = places[place] + NORMAL * this.vertexNormals[place];
    }
    fill(this.normals, { position: attribute(ends, 3) });
  }

  // How things look, by what is checked.
  apply() {
    const { smooth, wires, cage, points, normals } = this.look;
    const { material } = this.surface;
    this.surface.visible = this.head.triangle_count > 0;
    if (material.flatShading === smooth) {
      material.flatShading = !smooth;
      material.needsUpdate = true;
    }
    const attributes = { position: this.places };
    if (this.colors) attributes.color = this.colors;
    if (smooth) {
      const { normal } = this.surface.geometry.attributes;
      attributes.normal = normal?.array === this.vertexNormals ? normal : attribute(this.vertexNormals, 3);
    }
    fill(this.surface, attributes, this.index);
    if (normals) this.showNormals();
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
      fill(object, kind === "face" ? { position, normal } : { position });
    }
  }
}

function attribute(array, size) {
  return new THREE.BufferAttribute(array, size);
}

// Gives an object a geometry of these buffers, unless it has it.
function fill(object, attributes, index = null) {
  const { geometry: known } = object;
  const names = Object.keys(attributes);
  if (known.index === index && names.length === Object.keys(known.attributes).length && names.every((name) => known.attributes[name] === attributes[name])) return;
  known.dispose();
  object.geometry = new THREE.BufferGeometry();
  for (const name of names) object.geometry.setAttribute(name, attributes[name]);
  object.geometry.setIndex(index);
}
