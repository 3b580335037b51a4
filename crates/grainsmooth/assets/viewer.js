// Shows the grains of the network that is embedded in the page; the slider moves them apart.
"use strict";
(() => {
  const network = JSON.parse(document.getElementById("network").textContent);
  const bytes = (text) => Uint8Array.from(atob(text), (character) => character.charCodeAt(0)).buffer;
  const steps = new Uint16Array(bytes(network.points));
  const corners = new Uint32Array(bytes(network.triangles));
  const { low, step, shifts, parts, colors } = network;

  // Each side of a boundary has vertices of its own: its grain's colour, its grain's shift, and normals that end at its rim.
  const positions = [], normals = [], grains = [], faces = [], rims = [];
  let first = 0;
  for (const part of parts) {
    const triangles = corners.subarray(3 * first, 3 * (first + part.count));
    first += part.count;
    part.sides.forEach((grain, side) => {
      if (grain >= 0) addPatch(triangles, grain, side === 1);
    });
  }

  function addPatch(triangles, grain, isSecond) {
    const start = grains.length;
    const local = new Map();
    const edges = new Map();
    const vertex = (point) => {
      if (!local.has(point)) {
        local.set(point, grains.length);
        grains.push(grain);
        for (let axis = 0; axis < 3; axis++) {
          positions.push(low[axis] + step[axis] * steps[3 * point + axis]);
          normals.push(0);
        }
      }
      return local.get(point);
    };
    const at = (v) => new THREE.Vector3(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]);
    for (let t = 0; t < triangles.length; t += 3) {
      let [a, b, c] = [triangles[t], triangles[t + 1], triangles[t + 2]].map(vertex);
      if (isSecond) [b, c] = [c, b];
      faces.push(a, b, c);
      const normal = at(b).sub(at(a)).cross(at(c).sub(at(a)));
      for (const v of [a, b, c]) {
        normals[3 * v] += normal.x;
        normals[3 * v + 1] += normal.y;
        normals[3 * v + 2] += normal.z;
      }
      for (const [from, to] of [[a, b], [b, c], [c, a]]) {
        const key = Math.min(from, to) * 0x4000000 + Math.max(from, to);
        if (!edges.delete(key)) edges.set(key, [from, to]);
      }
    }
    for (const [from, to] of edges.values()) rims.push(from, to);
    for (let v = start; v < grains.length; v++) {
      const length = Math.hypot(normals[3 * v], normals[3 * v + 1], normals[3 * v + 2]) || 1;
      for (let axis = 0; axis < 3; axis++) normals[3 * v + axis] /= length;
    }
  }

  const position = new THREE.BufferAttribute(new Float32Array(positions), 3);
  const color = new THREE.BufferAttribute(new Float32Array(positions.length), 3);
  const surface = new THREE.BufferGeometry();
  surface.setAttribute("position", position);
  surface.setAttribute("normal", new THREE.BufferAttribute(new Float32Array(normals), 3));
  surface.setAttribute("color", color);
  surface.setIndex(new THREE.BufferAttribute(new Uint32Array(faces), 1));
  const rim = new THREE.BufferGeometry();
  rim.setAttribute("position", position);
  rim.setIndex(new THREE.BufferAttribute(new Uint32Array(rims), 1));

  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0xffffff);
  scene.add(new THREE.AmbientLight(0xffffff, 1.6));
  const camera = new THREE.PerspectiveCamera(30, 1, 0.01, 100);
  const lamp = new THREE.DirectionalLight(0xffffff, 1.8);
  lamp.position.set(-0.4, 0.5, 1);
  camera.add(lamp);
  scene.add(camera);
  // Surfaces lie a little behind the lines at their rims, which would flicker.
  const material = new THREE.MeshLambertMaterial({ vertexColors: true, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
  scene.add(new THREE.Mesh(surface, material));
  const lines = new THREE.LineSegments(rim, new THREE.LineBasicMaterial({ color: 0x1a1a1a }));
  scene.add(lines);

  const view = document.getElementById("view");
  const renderer = new THREE.WebGLRenderer({ antialias: true });
  renderer.setPixelRatio(window.devicePixelRatio);
  view.appendChild(renderer.domElement);
  camera.up.set(0, 0, 1);
  const controls = new THREE.OrbitControls(camera, renderer.domElement);
  const draw = () => renderer.render(scene, camera);
  controls.addEventListener("change", draw);

  function moveApart() {
    const share = Number(document.getElementById("explode").value);
    for (let v = 0; v < grains.length; v++)
      for (let axis = 0; axis < 3; axis++)
        position.array[3 * v + axis] = positions[3 * v + axis] + share * shifts[grains[v]][axis];
    position.needsUpdate = true;
    surface.computeBoundingSphere();
    rim.computeBoundingSphere();
    draw();
  }

  function paint() {
    const chosen = colors[document.getElementById("coloring").value];
    for (let v = 0; v < grains.length; v++) {
      // What the page names in sRGB is shaded in linear light.
      const [red, green, blue] = chosen[grains[v]];
      const paint = new THREE.Color().setRGB(red, green, blue, "srgb");
      color.setXYZ(v, paint.r, paint.g, paint.b);
    }
    color.needsUpdate = true;
    draw();
  }

  function resize() {
    const { clientWidth, clientHeight } = view;
    renderer.setSize(clientWidth, clientHeight);
    camera.aspect = clientWidth / clientHeight;
    camera.updateProjectionMatrix();
    draw();
  }

  document.getElementById("explode").addEventListener("input", moveApart);
  document.getElementById("coloring").addEventListener("input", paint);
  document.getElementById("lines").addEventListener("input", (event) => {
    lines.visible = event.target.checked;
    draw();
  });
  window.addEventListener("resize", resize);
  moveApart();
  // As near as shows all: half the angle of view touches the sphere round the grains.
  const distance = surface.boundingSphere.radius / Math.sin((camera.fov * Math.PI) / 360);
  camera.position.set(0.45, -0.78, 0.51).setLength(distance);
  controls.update();
  resize();
  paint();
  view.dataset.triangles = renderer.info.render.triangles;
})();
