// The page of grains: what the controls do, in `grainsmooth view` and in reports.
import { css, kind, NOTHING, range, scale, share } from "./colors.js";
import { Network } from "./network.js";
import { button, check, choice, digits, element, facts, group, row, say, slider } from "./panel.js";
import { unpack } from "./packed.js";

const SURFACE_COLOR = [0.85, 0.79, 0.66]; // sand, of what is no grains
const PALE = [0.94, 0.94, 0.94]; // of grains between lines that are coloured
const APART = 0.3; // by how much of their distance from the middle the grains of a report stand apart
const AXES = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };

// `source` gives steps and arrays of a series; reports have none. `onselect` hears of the grain that is clicked, by its number in files.
export class GrainsPage {
  constructor(stage, panel, buffer, source = null, onselect = () => {}) {
    this.stage = stage;
    this.source = source;
    this.onselect = onselect;
    this.hidden = new Set();
    this.selected = -1;
    this.legend = element("div", { className: "legend" });
    stage.view.append(this.legend);
    const unpacked = unpack(buffer);
    this.isPlane = unpacked.head.is_plane;
    if (this.isPlane) stage.lookFromAbove();
    this.build(panel, unpacked.head);
    this.show(unpacked);
    this.fit();
    stage.onhover = (event) => this.hover(event);
    stage.onclick = (event) => this.click(event);
    stage.ondoubleclick = (event) => this.center(event);
  }

  build(panel, head) {
    if (head.steps?.length > 1) {
      const { steps } = head;
      const series = group(panel, "Series");
      slider(series, "Step", { id: "step", max: steps.length - 1, step: 1, value: head.step, say: (step) => steps[step].label }, (step) => this.load(step));
    }
    const look = group(panel, "Look");
    this.withLines = check(look, head.columns.length > 0 ? "triple lines" : "boundaries", { id: "lines", value: true }, () => this.change(() => this.lines()));
    if (head.columns.length > 0) this.buildGrains(panel, look);
    const view = group(panel, "View");
    const views = row(view);
    const directions = this.isPlane ? [] : [["X", [1, 0, 0]], ["Y", [0, -1, 0]], ["Z", [0, 0, 1]]];
    for (const [axis, direction] of directions)
      button(views, axis, { id: `along-${axis.toLowerCase()}`, key: axis, title: `look along ${axis.toLowerCase()}` }, () => this.fit(direction));
    button(views, "All", { id: "fit", key: "0" }, () => this.fit());
    button(row(view), "Save picture", { id: "save", key: "P" }, () => this.stage.save("grains.png"));
    const drag = this.isPlane ? "Drag moves" : "Drag turns, Shift or the right button moves";
    view.append(element("p", { textContent: `${drag}, the wheel zooms, a double click sets the middle.` }));
  }

  // Looks at all of it.
  fit(direction = this.isPlane ? [0, 0, 1] : undefined) {
    this.stage.fit(this.network.radius(), direction);
  }

  // What a surface that is no grains has no use for.
  buildGrains(panel, look) {
    this.coloring = choice(look, "Colours", { id: "coloring", options: [["different", "grains"]] }, () => this.color());
    this.explosion = slider(look, "Explode", { id: "explode", max: 1.5, value: this.source ? 0 : APART }, (share) => this.change(() => this.explode(share)));
    if (!this.isPlane) this.buildSlice(panel);
    this.buildPicking(panel);
  }

  explode(share) {
    this.network.explode(share);
    this.stage.reach = 1.1 * this.network.radius();
  }

  buildSlice(panel) {
    const slice = group(panel, "Slice");
    this.axis = choice(slice, "Plane", { id: "axis", options: [["", "none"], ["x", "across x"], ["y", "across y"], ["z", "across z"], ["view", "as seen now"]] }, () => this.slice(true));
    this.depth = slider(slice, "At", { id: "depth", min: -0.5, max: 0.5, step: 0.005, value: 0, say: digits }, () => this.slice(false));
    this.turned = check(slice, "the other side", { id: "turned" }, () => this.slice(false));
  }

  buildPicking(panel) {
    const pick = group(panel, "Grains");
    this.mode = choice(pick, "A click", { id: "mode", options: [["select", "selects"], ["hide", "hides"], ["isolate", "isolates"]] }, () => {});
    const buttons = row(pick);
    button(buttons, "Hide", { id: "hide", key: "H" }, () => this.hide(this.selected));
    button(buttons, "Isolate", { id: "isolate", key: "I" }, () => this.isolate(this.selected));
    button(buttons, "Show all", { id: "all", key: "Shift+H" }, () => this.showAll());
    this.facts = element("dl");
    pick.append(this.facts);
  }

  // Shows an unpacked step.
  show(unpacked) {
    this.network?.dispose();
    this.head = unpacked.head;
    this.network = new Network(unpacked, scale);
    this.stage.scene.add(...this.network.objects);
    if (this.coloring) this.offerColors();
    const { uniforms } = this.network;
    uniforms.explode.value = this.explosion?.value ?? 0;
    uniforms.exploded.value = uniforms.explode.value > 0;
    this.stage.reach = 1.1 * this.network.radius();
    this.applyHidden();
    if (this.axis) this.slice(false);
    this.color();
    this.lines();
    this.stage.view.dataset.triangles = this.network.triangles;
    say(this.counts(unpacked.arrays.corners.length / 3));
  }

  counts(triangles) {
    const grains = `${this.head.ids.length} grains`;
    if (this.isPlane) return grains;
    return this.coloring ? `${grains}, ${this.head.boundaries.length} boundaries, ${triangles} triangles` : `${triangles} triangles`;
  }

  offerColors() {
    const columns = this.head.columns.map(({ name }, number) => [`column ${number}`, name]);
    const fields = (this.source ? this.head.fields : []).map((name, number) => [`field ${number}`, `array ${name}`]);
    const chosen = this.coloring.input.value;
    this.coloring.fill([["different", "grains"], ...columns, ...fields]);
    if ([...this.coloring.input.options].some((option) => option.value === chosen)) this.coloring.input.value = chosen;
  }

  change(work) {
    work();
    this.stage.view.dataset.triangles = this.network.triangles;
    this.stage.draw();
  }

  async load(step) {
    try {
      this.show(unpack(await this.source.step(step)));
      this.stage.draw();
    } catch (error) {
      say(error.message, true);
    }
  }

  lines() {
    this.network.lines.visible = this.withLines.checked;
    this.network.cut.visible = this.withLines.checked;
  }

  slice(isNew) {
    const axis = this.axis.input.value;
    if (isNew && axis === "view") this.seen = this.stage.camera.position.clone().sub(this.stage.controls.target).normalize().toArray();
    const direction = AXES[axis] ?? this.seen;
    const sign = this.turned.checked ? -1 : 1;
    const plane = axis ? [...direction.map((one) => sign * one), sign * this.depth.value] : null;
    this.change(() => this.network.slice(plane));
  }

  // The fact of a grain that is its colour, or all of them.
  async color() {
    if (!this.coloring) return this.network.paint(() => SURFACE_COLOR);
    const [what, number] = this.coloring.input.value.split(" ");
    const { network, head } = this;
    try {
      if (what === "field") {
        const { arrays: { values } } = unpack(await this.source.array(head.step, Number(number)));
        const bounds = range(values);
        // In the plane points and segments are of lines alone.
        if (this.isPlane) network.paint(() => PALE);
        network.paintValues(values, bounds, this.isPlane);
        this.bar(head.fields[number], bounds);
      } else if (what === "column") {
        this.paintColumn(head.columns[number]);
      } else {
        network.paint((grain) => kind(head.different[grain]));
        this.legend.replaceChildren();
      }
    } catch (error) {
      say(error.message, true);
    }
    this.stage.view.dataset.coloring = this.coloring.input.value;
    this.stage.draw();
  }

  paintColumn({ name, values: { numbers, kinds, colors } }) {
    if (colors) {
      this.network.paint((grain) => colors[grain].map((channel) => channel / 255));
      this.legend.replaceChildren(name);
    } else if (kinds) {
      this.network.paint((grain) => (kinds[grain] === null ? NOTHING : kind(kinds[grain])));
      const all = [...new Set(kinds)].sort((a, b) => a - b);
      this.legend.replaceChildren(...all.map((number) => {
        const key = element("span", { className: "key" });
        key.style.background = css(number === null ? NOTHING : kind(number));
        return element("div", {}, key, number === null ? "none" : `${name} ${number}`);
      }));
    } else {
      const bounds = range(numbers);
      this.network.paint((grain) => scale(share(numbers[grain], bounds)));
      this.bar(name, bounds);
    }
  }

  bar(name, [low, high]) {
    const bar = element("span", { className: "bar" });
    bar.style.background = `linear-gradient(to right, ${Array.from({ length: 10 }, (_, step) => css(scale(step / 9))).join(", ")})`;
    const ends = element("span", { className: "ends" }, element("span", { textContent: digits(low) }), element("span", { textContent: digits(high) }));
    this.legend.replaceChildren(name, bar, ends);
  }

  pick(event) {
    return this.network.pick(this.stage.ray(event));
  }

  hover(event) {
    if (!this.coloring) return;
    const grain = this.pick(event);
    this.stage.view.dataset.hovered = grain < 0 ? "" : this.head.ids[grain];
    if (grain < 0) return;
    const { volume, neighbors } = this.head.facts[grain];
    say(`grain ${this.head.ids[grain]} · ${this.isPlane ? "area" : "volume"} ${digits(volume)} · ${neighbors} neighbours`);
  }

  click(event) {
    if (!this.coloring) return;
    const grain = this.pick(event);
    const mode = this.mode.input.value;
    if (mode === "hide") this.hide(grain);
    else if (mode === "isolate") this.isolate(grain);
    else this.choose(grain);
  }

  // Selects a grain by its place; -1 selects none.
  choose(grain) {
    this.selected = grain;
    this.network.uniforms.selected.value = grain;
    const id = grain < 0 ? "" : this.head.ids[grain];
    this.stage.view.dataset.selected = id;
    const columns = this.head.columns.filter(({ values }) => !values.colors);
    facts(this.facts, grain < 0 ? [] : [["grain", id], ...columns.map(({ name, values }) => [name, digits((values.numbers ?? values.kinds)[grain])])]);
    this.onselect(id);
    this.stage.draw();
  }

  // Selects a grain by its number in files.
  chooseId(id) {
    this.choose(this.head.ids.indexOf(id));
  }

  applyHidden() {
    const { ids } = this.head;
    this.network.show((grain) => (this.only !== undefined ? ids[grain] === this.only : !this.hidden.has(ids[grain])));
    this.stage.view.dataset.shown = this.network.isShown.reduce((sum, one) => sum + one, 0);
  }

  hide(grain) {
    if (grain < 0) return say("Click a grain first.");
    this.hidden.add(this.head.ids[grain]);
    this.only = undefined;
    this.change(() => this.applyHidden());
  }

  isolate(grain) {
    if (grain < 0) return say("Click a grain first.");
    this.only = this.head.ids[grain];
    this.change(() => this.applyHidden());
  }

  showAll() {
    this.hidden.clear();
    this.only = undefined;
    this.change(() => this.applyHidden());
  }

  center(event) {
    const grain = this.pick(event);
    if (grain < 0) return;
    const piece = this.network.pieceOf[grain];
    const center = this.head.centers[piece].map((place, axis) => place + this.network.shift(piece, axis));
    this.stage.center(new THREE.Vector3(...center));
  }
}
