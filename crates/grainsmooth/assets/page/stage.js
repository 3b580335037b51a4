// The canvas: camera, turning and zooming, drawing when something changed and no more.
const SLOW_FRAME = 60; // ms; above this, turning takes half as many pixels a side
const CLICK = 4; // pixels that a pointer may move within a click

export class Stage {
  constructor(view) {
    this.view = view;
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color(0xffffff);
    this.camera = new THREE.PerspectiveCamera(30, 1, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.scene.add(this.camera);
    this.renderer = new THREE.WebGLRenderer({ antialias: true });
    this.renderer.setPixelRatio(window.devicePixelRatio);
    view.append(this.renderer.domElement);
    this.controls = new THREE.OrbitControls(this.camera, this.renderer.domElement);
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", () => this.draw());
    this.controls.addEventListener("start", () => { this.isTurning = true; });
    this.controls.addEventListener("end", () => this.rest());
    this.reach = 3; // how far what is drawn may lie from the origin
    this.isAsked = false;
    this.frame = () => this.render();
    this.frames = 0;
    new ResizeObserver(() => this.resize()).observe(view);
    this.renderer.domElement.addEventListener("webglcontextrestored", () => this.draw());
    this.listen();
    this.resize();
  }

  // Asks for a frame; several calls before it make one.
  draw() {
    if (this.isAsked) return;
    this.isAsked = true;
    requestAnimationFrame(this.frame);
  }

  render() {
    this.isAsked = false;
    const start = performance.now();
    this.setDepths();
    this.renderer.render(this.scene, this.camera);
    this.script = performance.now() - start;
    this.frames++;
    if (!this.isTurning) return;
    const now = performance.now();
    if (this.last && now - this.last > SLOW_FRAME && now - this.last < 2000 && !this.isCoarse) {
      this.isCoarse = true;
      this.renderer.setPixelRatio(window.devicePixelRatio / 2);
    }
    this.last = now;
  }

  // Depths are as exact as they can be: where walls of grains meet they differ by little.
  setDepths() {
    const { camera } = this;
    const distance = camera.position.length();
    camera.near = Math.max(0.01 * distance, distance - this.reach);
    camera.far = distance + this.reach;
    camera.updateProjectionMatrix();
  }

  rest() {
    this.isTurning = false;
    this.last = 0;
    if (!this.isCoarse) return;
    this.isCoarse = false;
    this.renderer.setPixelRatio(window.devicePixelRatio);
    this.draw();
  }

  resize() {
    const { clientWidth, clientHeight } = this.view;
    if (!clientWidth || !clientHeight) return;
    this.renderer.setSize(clientWidth, clientHeight);
    this.camera.aspect = clientWidth / clientHeight;
    this.render();
  }

  // Looks at a ball round the origin from a corner, or along an axis.
  fit(radius, direction = [0.45, -0.78, 0.51]) {
    this.controls.target.set(0, 0, 0);
    const angle = Math.min(1, this.camera.aspect) * (this.camera.fov * Math.PI) / 360;
    this.camera.position.set(...direction).setLength(radius / Math.sin(angle));
    this.controls.update();
    this.draw();
  }

  // What lies in the plane is moved, not turned.
  lookFromAbove() {
    this.controls.enableRotate = false;
    this.controls.mouseButtons.LEFT = this.controls.mouseButtons.RIGHT;
    this.controls.touches.ONE = 1;
  }

  // Makes a place the middle of all turning.
  center(place) {
    const move = place.clone().sub(this.controls.target);
    this.controls.target.copy(place);
    this.camera.position.add(move);
    this.controls.update();
    this.draw();
  }

  // Where a pointer is on the canvas, in pixels.
  pixel(event) {
    const box = this.renderer.domElement.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  // The ray under a pointer, and how wide a pixel is at distance 1.
  ray(event) {
    const [x, y] = this.pixel(event);
    const { clientWidth, clientHeight } = this.view;
    const end = new THREE.Vector3((2 * x) / clientWidth - 1, 1 - (2 * y) / clientHeight, 0.5).unproject(this.camera);
    const origin = this.camera.position;
    const direction = end.sub(origin).normalize();
    const pixel = (2 * Math.tan((this.camera.fov * Math.PI) / 360)) / clientHeight;
    return { origin: origin.toArray(), direction: direction.toArray(), pixel };
  }

  // Tells apart clicks and turning: sets `onhover`, `onclick`, `ondoubleclick`, `ongrab` (true keeps the camera still), `ondrag`, `ondrop`.
  listen() {
    const canvas = this.renderer.domElement;
    let down = null;
    let grabbed = false;
    canvas.addEventListener("pointerdown", (event) => {
      down = event.button === 0 ? [event.clientX, event.clientY] : null;
      grabbed = Boolean(down && this.ongrab?.(event));
      if (!grabbed) return;
      event.stopImmediatePropagation();
      canvas.setPointerCapture(event.pointerId);
    }, { capture: true });
    canvas.addEventListener("pointermove", (event) => {
      if (grabbed) this.ondrag?.(event);
      else if (event.buttons === 0) this.onhover?.(event);
    });
    canvas.addEventListener("pointerup", (event) => {
      if (grabbed) this.ondrop?.(event);
      const isClick = down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < CLICK;
      if (isClick) this.onclick?.(event);
      grabbed = false;
      down = null;
    });
    canvas.addEventListener("dblclick", (event) => this.ondoubleclick?.(event));
  }

  // Saves what is drawn as PNG. Later than in the same task the canvas is empty.
  save(name) {
    this.render();
    this.renderer.domElement.toBlob((blob) => download(blob, name));
  }
}

export function download(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
