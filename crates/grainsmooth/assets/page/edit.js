// The page of meshes, curves and Bezier patches: what the controls do. Geometry is the program's; here it is drawn and asked for.
import { button, check, choice, digits, element, group, row, say, slider } from "./panel.js";
import { css, scale } from "./colors.js";
import { unpack } from "./packed.js";
import { ask, askBytes, newest, Refused } from "./server.js";
import { Shape } from "./shape.js";
import { download } from "./stage.js";

const SCHEMES = {
  mesh: [["", "none"], ["loop", "Loop"], ["butterfly", "butterfly"], ["modified-butterfly", "modified butterfly"], ["midpoint", "midpoints"], ["catmull-clark", "Catmull-Clark"], ["doo-sabin", "Doo-Sabin"]],
  curves: [["b-spline", "cubic B-spline"], ["four-point", "four points, interpolating"]],
};
const FORMATS = { mesh: ["vtp", "obj", "ply", "stl", "vtu", "vtk", "json"], curves: ["vtp", "obj", "vtk", "json"], bezier: ["json", "vtp", "obj", "ply", "stl", "vtu", "vtk"] };
const BUBBLE = 5000; // ms for which a reason stays where something was tried
const MOST_HELD = 200000; // triangles of what follows a point while it is held

export class EditPage {
  constructor(stage, panel, buffer) {
    this.stage = stage;
    this.shape = new Shape(stage);
    this.turn = Promise.resolve();
    this.unpacked = unpack(buffer);
    this.model = this.unpacked.head.model;
    this.view = { scheme: this.model === "curves" ? "b-spline" : "", level: 0, color: "", t: 0.4, v: 0.5, patch: 0, samples: 17 };
    this.legend = element("div", { className: "legend" });
    this.bubble = element("div", { className: "bubble", role: "alert" });
    stage.view.append(this.legend, this.bubble);
    // Patches are smooth: their triangles are no part of them.
    this.shape.look.wires = this.model !== "bezier";
    this.build(panel, this.unpacked.head);
    this.saved = 0;
    this.show(this.unpacked);
    this.fit();
    stage.onhover = newest((event) => this.hover(event));
    stage.onclick = (event) => this.click(event);
    stage.ondoubleclick = (event) => this.center(event);
    stage.ongrab = () => this.grab();
    stage.ondrag = (event) => this.drag(event);
    stage.ondrop = () => this.drop();
    this.hold = newest((place) => this.held(place));
    this.redraw = newest(() => this.draw());
    window.addEventListener("beforeunload", (event) => {
      if (this.head.undo !== this.saved) event.preventDefault();
    });
    this.listen();
    if (this.model === "mesh") say(this.counts());
    else this.redraw();
  }

  build(panel, head) {
    const isMesh = this.model === "mesh";
    const history = group(panel, "Changes");
    const buttons = row(history);
    this.undo = button(buttons, "Undo", { id: "undo", key: "Ctrl+Z" }, () => this.change("undo"));
    this.redo = button(buttons, "Redo", { id: "redo", key: "Ctrl+Shift+Z" }, () => this.change("redo"));
    if (isMesh) this.buildEdits(panel);
    else this.what = { input: { value: "point" } };
    if (SCHEMES[this.model]) {
      const subdivision = group(panel, "Subdivision");
      choice(subdivision, "Scheme", { id: "scheme", options: SCHEMES[this.model], value: this.view.scheme }, (scheme) => this.look({ scheme }));
      this.level = slider(subdivision, "Level", { id: "level", max: isMesh ? 6 : 8, step: 1, value: 0 }, (level) => this.look({ level }));
    } else {
      this.buildBezier(panel, head);
    }
    const look = group(panel, "Look");
    if (this.model !== "curves") {
      choice(look, "Shading", { id: "shading", options: [["flat", "flat"], ["smooth", "smooth"]] }, (shading) => this.appear({ smooth: shading === "smooth" }));
      choice(look, "Colours", { id: "coloring", options: [["", "none"], ["generation", "generation"], ["curvature", "mean curvature"], ["valence", "valence"]] }, (color) => this.look({ color }));
      check(look, "edges of the surface", { id: "wires", value: isMesh, key: "W" }, (wires) => this.appear({ wires }));
      check(look, "normals", { id: "normals", key: "N" }, (normals) => this.appear({ normals }));
    }
    check(look, "control points", { id: "points", value: true }, (points) => this.appear({ points }));
    check(look, isMesh ? "control cage" : "control lines", { id: "cage", value: true, key: "G" }, (cage) => this.appear({ cage }));
    const save = group(panel, "Save");
    this.format = choice(save, "Format", { id: "format", options: FORMATS[this.model].map((format) => [format, "." + format]) }, () => {});
    if (this.model !== "bezier") this.whole = check(save, "the level that is shown", { id: "whole" }, () => {});
    const saves = row(save);
    button(saves, "Download", { id: "download" }, () => this.download());
    this.overwrite = button(saves, "Save", { id: "save", key: "Ctrl+S", title: "over the file that was opened" }, () => this.save());
    const views = row(group(panel, "View"));
    for (const [axis, place] of [["X", [1, 0, 0]], ["Y", [0, -1, 0]], ["Z", [0, 0, 1]]]) button(views, axis, { key: axis }, () => this.fit(place));
    button(views, "All", { key: "0" }, () => this.fit());
    button(views, "Picture", { id: "picture", key: "P" }, () => this.stage.save("mesh.png"));
    panel.append(element("p", { textContent: "Drag a point to move it. Else: drag turns, Shift or the right button moves, the wheel zooms, a double click sets the middle." }));
  }

  buildEdits(panel) {
    const edges = group(panel, "Edit");
    this.what = choice(edges, "Pick", { id: "what", options: [["point", "points (1)"], ["edge", "edges (2)"], ["face", "faces (3)"]] }, () => this.select(null));
    this.act = choice(edges, "A click", { id: "act", options: [["select", "selects"], ["flip", "flips the edge"], ["split", "splits the edge"], ["collapse", "collapses the edge"], ["crease", "creases the edge"], ["corner", "makes a corner"]] }, (act) => {
      if (act !== "select") this.what.input.value = act === "corner" ? "point" : "edge";
    });
    document.addEventListener("keydown", (event) => {
      const what = { 1: "point", 2: "edge", 3: "face" }[event.key];
      if (!what || event.target.matches("select, input[type=number]")) return;
      this.what.input.value = what;
      this.select(null);
    });
    const first = row(edges);
    button(first, "Flip", { id: "flip", key: "F" }, () => this.onEdge("flip"));
    button(first, "Split", { id: "split", key: "S" }, () => this.onEdge("split"));
    button(first, "Collapse", { id: "collapse", key: "C" }, () => this.onEdge("collapse"));
    this.sharpness = element("input", { type: "number", id: "sharpness", min: 0, step: 0.5, placeholder: "infinite" });
    row(edges, element("span", { textContent: "Sharpness" }), this.sharpness);
    const second = row(edges);
    button(second, "Crease", { id: "crease", key: "K" }, () => this.onEdge("crease"));
    button(second, "Corner", { id: "corner", key: "O" }, () => this.onPoint("corner"));
    const all = group(panel, "All at once");
    const third = row(all);
    button(third, "Pre-split", { id: "presplit", title: "split the diagonals of flat polygons, so that Loop's surface is symmetric" }, () => this.change({ "split-many": "flat" }));
    button(third, "Split all", { id: "split-all" }, () => this.change({ "split-many": "all" }));
    button(third, "Split longest", { id: "split-longest" }, () => this.change({ "split-many": "longest" }));
    const fourth = row(all);
    button(fourth, "Flip flat", { id: "flip-flat" }, () => this.change({ "flip-many": "flat" }));
    button(fourth, "Triangulate", { id: "triangulate" }, () => this.change("triangulate"));
    button(fourth, "Reverse", { id: "reverse", title: "turn every face round" }, () => this.change("reverse"));
    button(fourth, "Orient", { id: "orient", title: "make winding agree, normals outward" }, () => this.change("orient"));
  }

  buildBezier(panel, head) {
    const bezier = group(panel, "Bezier");
    const names = Array.from({ length: head.patches }, (_, number) => [number, `number ${number}`]);
    choice(bezier, "Construct", { id: "patch", options: [[-1, "none"], ...names], value: 0 }, (patch) => this.look({ patch: patch < 0 ? 1e9 : Number(patch) }));
    slider(bezier, head.triangle_count > 0 ? "u" : "t", { id: "t", value: this.view.t }, (t) => this.look({ t }));
    if (head.triangle_count > 0) slider(bezier, "v", { id: "v", value: this.view.v }, (v) => this.look({ v }));
    slider(bezier, "Points", { id: "samples", min: 2, max: 40, step: 1, value: this.view.samples }, (samples) => this.look({ samples }));
  }

  // What is asked for with each command: what is to be seen, and the number of what is known.
  asked(view = this.view) {
    return { view, known: this.unpacked.head.told };
  }

  // Asks for a drawing, and shows it; of what is known the program sends changes alone, so one is asked for after the other.
  update(path, words, isHeld = false) {
    const run = async () => {
      this.unpacked = unpack(await askBytes(path, words()), this.unpacked);
      this.show(this.unpacked, isHeld);
    };
    this.turn = this.turn.then(run, run);
    return this.turn;
  }

  show(unpacked, isHeld) {
    this.head = unpacked.head;
    this.shape.show(unpacked, isHeld);
    const { undo, redo, triangle_count: triangles, revision } = this.head;
    this.undo.disabled = undo === 0;
    this.redo.disabled = redo === 0;
    this.overwrite.disabled = !this.head.can_overwrite;
    this.bar();
    if (!isHeld) {
      document.getElementById("title").textContent = this.head.name;
      Object.assign(this.stage.view.dataset, { revision, undo, redo, triangles });
      this.revision = revision;
    }
    this.stage.draw();
  }

  // Looks at all of it; at what is flat, from above.
  fit(direction) {
    const { points } = this.shape.arrays;
    let radius = 0.1, height = 0;
    for (let place = 0; place < points.length; place += 3) {
      radius = Math.max(radius, Math.hypot(points[place], points[place + 1], points[place + 2]));
      height = Math.max(height, Math.abs(points[place + 2]));
    }
    this.stage.fit(1.05 * radius, direction ?? (height === 0 ? [0, 0, 1] : undefined));
  }

  bar() {
    const { bounds } = this.shape;
    if (!bounds || !this.view.color) return this.legend.replaceChildren();
    const bar = element("span", { className: "bar" });
    bar.style.background = `linear-gradient(to right, ${Array.from({ length: 10 }, (_, step) => css(scale(step / 9))).join(", ")})`;
    const ends = element("span", { className: "ends" }, ...bounds.map((end) => element("span", { textContent: digits(end) })));
    this.legend.replaceChildren(this.view.color, bar, ends);
  }

  counts() {
    const { edge_count: edges, has_surface: isAbove, triangle_count: triangles } = this.head;
    const above = isAbove ? `; shown ${triangles} triangles` : "";
    return `${this.shape.arrays.points.length / 3} points, ${edges} edges${above}`;
  }

  // Another view of the same.
  look(change) {
    Object.assign(this.view, change);
    this.redraw();
  }

  // Another look of the same view.
  appear(change) {
    Object.assign(this.shape.look, change);
    this.shape.apply();
    this.stage.draw();
  }

  async draw() {
    try {
      await this.update("/draw", () => this.asked());
      say(this.counts());
      this.stage.view.dataset.shown = JSON.stringify(this.view);
    } catch (error) {
      this.refuse(error);
      // What cannot be subdivided is shown as it is.
      if (this.level && this.view.level > 0) {
        this.level.value = 0;
        this.view.level = 0;
        this.redraw();
      }
    }
  }

  // Changes what is edited.
  async change(command) {
    try {
      await this.update("/edit", () => ({ revision: this.revision, command, look: this.asked() }));
      say(`${this.head.said} · ${this.counts()}`);
      this.selected = null;
    } catch (error) {
      this.refuse(error);
      // Another page changed it, or a point was held that does not stay.
      if ((error instanceof Refused && error.status === 409) || command.move) this.redraw();
      else this.shape.mark(this.selected);
      this.stage.draw();
    }
  }

  // Says why, below and where it was tried.
  refuse(error) {
    say(error.message, true);
    if (!this.pointer) return;
    this.bubble.textContent = error.message;
    this.bubble.style.left = `${Math.min(this.pointer[0] + 12, this.stage.view.clientWidth - 260)}px`;
    this.bubble.style.top = `${this.pointer[1] + 12}px`;
    this.bubble.classList.add("shown");
    clearTimeout(this.hiding);
    this.hiding = setTimeout(() => this.bubble.classList.remove("shown"), BUBBLE);
  }

  async pick(event) {
    this.pointer = this.stage.pixel(event);
    return ask("/pick", { ...this.stage.ray(event), what: this.what.input.value });
  }

  async hover(event) {
    try {
      const picked = await this.pick(event);
      if (this.grabbed !== undefined) return;
      this.hovered = picked === "nothing" ? null : picked;
      this.stage.view.dataset.hovered = JSON.stringify(this.hovered);
      this.shape.mark(this.hovered ?? this.selected);
      this.stage.draw();
    } catch (error) {
      this.refuse(error);
    }
  }

  async click(event) {
    try {
      const picked = await this.pick(event);
      this.select(picked === "nothing" ? null : picked);
      const act = this.act?.input.value ?? "select";
      if (act === "corner") this.onPoint(act);
      else if (act !== "select") this.onEdge(act);
    } catch (error) {
      this.refuse(error);
    }
  }

  select(picked) {
    this.selected = picked;
    this.shape.mark(picked);
    this.stage.view.dataset.selected = JSON.stringify(picked);
    if (picked) say(this.describe(picked));
    this.stage.draw();
  }

  describe({ point, edge, face }) {
    if (edge) return `edge ${edge[0]}-${edge[1]}`;
    if (face) return `triangle ${face.join(" ")}`;
    const { middle, unit } = this.head;
    return `point ${point} at ${[...this.shape.place(point)].map((place, axis) => digits(middle[axis] + unit * place)).join(", ")}`;
  }

  onEdge(what) {
    const edge = this.selected?.edge ?? this.hovered?.edge;
    if (!edge) return say("Pick an edge first: choose edges, and click one.", true);
    this.change({ [what]: what === "crease" ? { edge, sharpness: this.sharp(this.head.creases.some(([ends]) => same(ends, edge))) } : { edge } });
  }

  onPoint(what) {
    const point = this.selected?.point ?? this.hovered?.point;
    if (point === undefined) return say("Pick a point first: choose points, and click one.", true);
    this.change({ [what]: { point, sharpness: this.sharp(this.head.corners.some(([corner]) => corner === point)) } });
  }

  // The sharpness that was typed, infinite where none was; nothing takes away what is there.
  sharp(isThere) {
    if (isThere) return null;
    return this.sharpness.value === "" ? "infinite" : Number(this.sharpness.value);
  }

  grab() {
    if (this.hovered?.point === undefined) return false;
    this.grabbed = this.hovered.point;
    this.start = new THREE.Vector3(...this.shape.place(this.grabbed));
    this.place = null;
    return true;
  }

  // Where the pointer is in the plane of the screen through the point that is held.
  drag(event) {
    this.pointer = this.stage.pixel(event);
    const { origin, direction } = this.stage.ray(event);
    const [from, along] = [origin, direction].map((place) => new THREE.Vector3(...place));
    const forward = this.stage.controls.target.clone().sub(this.stage.camera.position).normalize();
    const distance = this.start.clone().sub(from).dot(forward) / along.dot(forward);
    this.place = from.addScaledVector(along, distance).toArray();
    this.hold(this.place);
  }

  async held(place) {
    if (this.grabbed === undefined) return;
    try {
      const isSlow = this.head.triangle_count > MOST_HELD && this.view.scheme !== "loop";
      const point = this.grabbed;
      const look = () => this.asked(isSlow ? { ...this.view, level: 0 } : this.view);
      await this.update("/hold", () => ({ point, to: place, look: look() }), true);
      if (this.grabbed !== undefined) this.shape.mark({ point: this.grabbed });
    } catch (error) {
      this.refuse(error);
    }
  }

  async drop() {
    const point = this.grabbed;
    this.grabbed = undefined;
    if (this.place) await this.change({ move: { point, to: this.place } });
    this.hovered = null;
  }

  center() {
    const picked = this.hovered ?? this.selected;
    if (!picked) return;
    const corners = [Object.values(picked)[0]].flat();
    const middle = new THREE.Vector3();
    for (const corner of corners) middle.add(new THREE.Vector3(...this.shape.place(corner)));
    this.stage.center(middle.divideScalar(corners.length));
  }

  wanted(format) {
    const isLevel = this.model === "bezier" || (this.whole?.checked && this.view.level > 0);
    return { format, view: isLevel ? this.view : null, anyway: false };
  }

  async download() {
    const format = this.format.input.value;
    try {
      const bytes = await askBytes("/file", this.wanted(format));
      download(new Blob([bytes]), `${this.head.name.replace(/\.[^.]*$/, "")}.${format}`);
      this.saved = this.head.undo;
    } catch (error) {
      this.refuse(error);
    }
  }

  async save() {
    try {
      say(await ask("/save", { ...this.wanted(""), anyway: this.isWarned ?? false, revision: this.revision }));
      this.isWarned = false;
      this.saved = this.head.undo;
    } catch (error) {
      this.isWarned = error.status === 412;
      this.refuse(error);
    }
  }

  // Hears of changes by other pages.
  async listen() {
    try {
      for (;;) {
        const revision = await ask("/news", this.revision);
        if (revision !== this.revision) await this.draw();
      }
    } catch (error) {
      this.refuse(error);
    }
  }
}

function same(a, b) {
  return (a[0] === b[0] && a[1] === b[1]) || (a[0] === b[1] && a[1] === b[0]);
}
