// `Arm3D`: an arm in meshcat's viewer, its joints moved here, its links coloured by how their joints fare.

const UNKNOWN_STAGE = { name: "", colour: "#888888", words: "", least: 0, most: 0 };
const VIEW = [1, -1.15, 0.62]; // from where the arm is seen, z up
const FILLED = { wide: 0.92, tall: 0.78 }; // shares of the picture that the arm fills at most, beside head and legend
const LEAST_ARM = 0.5; // share of what is framed that the arm has at least, by the diagonals of their boxes
const PAPER = [1000, 440]; // [px], of a still picture
const ACCENT = "#2f8fdd"; // of what is selected

class Arm3D {
  // element: filled by the picture; scene: `Scene.to_dict()`.
  // options: stages [{name, colour, words, least, most}], theme "light" | "dark" (the system's if left out),
  //          zoom "always" (else the wheel zooms only where the picture has the focus).
  constructor(element, scene, options = {}) {
    this.scene = scene;
    this.stages = options.stages || [];
    this.torqueScale = null; // [N·m or N] that an arc of full length means, for each joint
    this.onSelect = null;
    this._theme = options.theme || null;
    this._zoom = options.zoom || "focus";
    this._shown = { position: scene.home, desired: null, stage: null, level: null, torque: null, label: "", attached: null };
    this._selected = null;
    this._index = new Map(scene.joints.map((j, k) => [j.name, k]));
    this._axes = scene.joints.map((j) => new THREE.Vector3(...j.axis));
    this._build(element);
    this._fill();
    this.frame([scene.home]);
    this.pose(scene.home);
    this._listen();
    this._painter = new Painter(this.viewer, this._links, this._lights, this._ground, () => this._placePins());
  }

  // Tell that a motion is being shown: while it is, speed goes before beauty where drawing is slow.
  set moving(value) { this._painter.moving = value; }

  // Frames drawn so far.
  get frames() { return this._painter.frames; }

  // Show a pose. What is left out stays as it was; null takes it away.
  pose(position, { desired, stage, level, torque, label, attached } = {}) {
    const given = { position, desired, stage, level, torque, label, attached };
    for (const [key, value] of Object.entries(given)) if (value !== undefined) this._shown[key] = value;
    this._move(this._arm, this._shown.position);
    this.ghost.visible = Boolean(this._shown.desired);
    if (this.ghost.visible) this._move(this._ghostGroups, this._shown.desired);
    this._colour();
    this._mark();
    this._attached.show(this._shown.attached);
    this._say();
    this.viewer.set_dirty();
  }

  // Highlight a joint's link; null none.
  select(joint) {
    this._selected = this._index.has(joint) ? joint : null;
    for (const link of this._links) if (link.outline) link.outline.visible = link.joint === this._selected;
    this._mark();
    this._say();
    this.viewer.set_dirty();
  }

  // Point the camera so that the whole arm is in the picture in each of some positions.
  frame(positions) {
    const points = [];
    for (const position of positions) {
      this._move(this._arm, position);
      this._settle();
      for (const { joint, mesh } of this._links) if (joint !== null) points.push(...corners(mesh));
    }
    this._move(this._arm, this._shown.position);
    this._framed = [...points, ...this._foot(points)];
    this.resetView();
  }

  // The camera as it was at the beginning.
  resetView() {
    const { camera, controls } = this.viewer;
    const away = new THREE.Vector3(...VIEW).normalize();
    const right = new THREE.Vector3(0, 0, 1).cross(away).normalize(), up = away.clone().cross(right);
    const slope = Math.tan((0.5 * camera.fov * Math.PI) / 180);
    const tall = slope * FILLED.tall, wide = slope * camera.aspect * FILLED.wide;
    const seen = this._framed.map((p) => [p.dot(right), p.dot(up), p.dot(away)]);
    const across = fitted(seen.map(([x, , z]) => [x, z]), wide), upright = fitted(seen.map(([, y, z]) => [y, z]), tall);
    const depths = seen.map(([, , z]) => z), middle = 0.5 * (Math.min(...depths) + Math.max(...depths));
    const distance = Math.max(across.from, upright.from) - middle;
    const target = right.multiplyScalar(across.middle).addScaledVector(up, upright.middle).addScaledVector(away, middle);
    const turned = (v) => [v.x, v.z, -v.y]; // the camera's frame has y up
    camera.near = distance / 50;
    camera.far = distance * 20;
    controls.target.set(...turned(target));
    camera.position.set(...turned(target.clone().addScaledVector(away, distance)));
    this._ownView = false;
    this.viewer.set_dirty();
  }

  // Poses of all links in the frame of the base: the viewer's own scene has y up, and is left out until it draws again.
  _settle() {
    const { parent } = this._root;
    this._root.parent = null;
    this._root.updateMatrixWorld(true);
    this._root.parent = parent;
  }

  // What is shown, for tests and for who cannot see it.
  state() {
    this._settle();
    const joints = {};
    this.scene.joints.forEach((joint, k) => {
      const m = this._arm.get(joint.name).matrixWorld.elements;
      const main = this._mainLink(joint.name);
      joints[joint.name] = {
        colour: main ? displayed(main.material.color) : null,
        intensity: this._weights ? this._weights[k] : 0,
        stage: this._stage(k).name,
        world: [0, 1, 2, 3].map((r) => [m[r], m[r + 4], m[r + 8], m[r + 12]]),
      };
    });
    return {
      joints, ghost: this.ghost.visible, label: this._head.textContent, pin: this._pin.hidden ? "" : this._pin.textContent,
      arrow: this._worst === null ? null : this.scene.joints[this._worst].name, selected: this._selected,
      attached: this._shown.attached, arrowLength: this._attached.arrow.visible ? this._attached.shaft.scale.y : 0,
      arrowAt: this._attached.arrow.visible ? this._attached.arrow.position.toArray() : null,
      ballSize: this._attached.ball.visible ? this._attached.ball.scale.x : 0,
    };
  }

  // Keep a still picture of the present pose for paper, on which the viewer's own is blank.
  keepStill() {
    const { renderer } = this.viewer, { domElement } = renderer;
    if (!this.viewer.drawing) return;
    const size = renderer.getSize(new THREE.Vector2()), framed = this._framed, own = this._ownView;
    this._size(...PAPER);
    if (!own) this.frame([this._shown.position]);
    this.viewer.render();
    Object.assign(this._still, { width: domElement.width, height: domElement.height });
    this._still.getContext("2d").drawImage(domElement, 0, 0);
    this._framed = framed;
    this._size(size.x, size.y);
    if (!own) this.resetView();
    this.viewer.set_dirty();
  }

  _size(width, height) {
    const { renderer, camera } = this.viewer;
    renderer.setSize(width, height);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
  }

  dispose() {
    removeEventListener("beforeprint", this._onPrint);
    this._painter.stop();
    this._resize.disconnect();
    this._dark.removeEventListener("change", this._retheme);
    this.viewer.renderer.dispose();
    this.box.remove();
  }

  // ---------------------------------------------------------------- building

  _build(element) {
    const part = (name, tag = "div") => Object.assign(document.createElement(tag), { className: "arm3d-" + name });
    this.box = Object.assign(document.createElement("div"), { className: "arm3d" });
    this._pane = part("view");
    this._head = part("head");
    this._pin = part("pin");
    this._legend = part("legend", "ul");
    this._notes = part("notes", "details");
    this._still = part("still", "canvas");
    this._tags = [part("pin"), part("pin")]; // of what acts on the whole arm
    const picture = part("picture");
    picture.append(this._pane, this._still, this._head, this._legend, this._notes);
    this.box.append(picture);
    element.append(this.box);
    for (const pin of [this._pin, ...this._tags]) pin.hidden = true;
    this._head.setAttribute("role", "status");
    this._pane.tabIndex = 0;
    this._pane.setAttribute("role", "img");
    this._pane.setAttribute("aria-label", "The arm " + this.scene.robot);
    this.viewer = meshcatViewer(this._pane);
    this._pane.append(this._pin, ...this._tags);
    if (this.viewer.drawing) this._note(this.scene.noted, this.scene.notes);
    else this._note("This browser has no WebGL: the arm cannot be drawn here.", []);
  }

  // One line, which unfolds to several: what could not be drawn as the file says.
  _note(line, more) {
    const node = (tag, text) => Object.assign(document.createElement(tag), { textContent: text });
    const list = document.createElement("ul");
    list.append(...more.map((text) => node("li", text)));
    this._notes.replaceChildren(node("summary", line), list);
    this._notes.hidden = !line;
  }

  _fill() {
    const { root, groups } = chainOf(this.scene.joints);
    const ghost = chainOf(this.scene.joints);
    this._root = root;
    this._arm = groups;
    this.ghost = ghost.root;
    this._ghostGroups = ghost.groups;
    this._ghostSkins = [];
    this._links = [];
    for (const given of this.scene.meshes) {
      const geometry = geometryOf(given), coarse = geometryOf(given.coarse);
      const fine = new THREE.MeshStandardMaterial({ color: linear(given.colour), roughness: 0.62, metalness: 0.0 });
      const plain = new THREE.MeshLambertMaterial();
      Object.assign(plain, { color: fine.color, emissive: fine.emissive }); // one colour, whichever is in use
      const mesh = new THREE.Mesh(geometry, fine);
      mesh.castShadow = mesh.receiveShadow = true;
      mesh.userData.joint = given.joint;
      groups.get(given.joint).add(mesh);
      const link = {
        joint: given.joint, mesh, own: new THREE.Color(given.colour), material: fine,
        fine: [geometry, fine], coarse: [coarse, plain], ghost: [], outline: null,
      };
      this._links.push(link);
      if (given.joint === null) continue;
      link.outline = outlineOf(geometry, ACCENT);
      link.outline.visible = false;
      mesh.add(link.outline);
      link.ghost = ghostOf(geometry);
      ghost.groups.get(given.joint).add(...link.ghost);
      this._ghostSkins.push(link.ghost[1].material);
    }
    const whole = new THREE.Box3().setFromObject(root);
    this.reach = whole.getSize(new THREE.Vector3()).length();
    this._torque = new TorqueMark(Math.min(this.reach, 1.6));
    this._attached = new Attached(root, groups, Math.min(this.reach, 1.6), this.scene.weight);
    this._ground = groundOf(this.reach, Math.min(0, this._lowest()));
    this._lights = lightsOf(this.reach);
    this.viewer.set_object(["Lights", "soft"], this._lights);
    this.viewer.set_object(["Ground"], this._ground);
    this.viewer.set_object(["Arm"], root);
    this.viewer.set_object(["Ghost"], ghost.root);
    this._retheme = () => this._applyTheme();
    this._dark = matchMedia("(prefers-color-scheme: dark)");
    this._applyTheme();
  }

  _lowest() {
    const box = new THREE.Box3();
    for (const { joint, mesh } of this._links) if (joint === null) box.expandByObject(mesh);
    return box.isEmpty() ? 0 : box.min.z;
  }

  // What of the base belongs into the picture: part by part, those near the arm first, while the arm still fills its share.
  // A pedestal does, and what of a humanoid is near the arm; a table or a hall does not: nobody would see how the arm moves.
  _foot(arm) {
    const box = new THREE.Box3().setFromPoints(arm), size = (b) => b.getSize(new THREE.Vector3()).length();
    const most = size(box) / LEAST_ARM, kept = [];
    const grown = (points) => new THREE.Box3().setFromPoints(points).union(box);
    const parts = this._links.filter((l) => l.joint === null).map((l) => corners(l.mesh)).sort((a, b) => size(grown(a)) - size(grown(b)));
    for (const part of parts) {
      const larger = grown(part);
      if (size(larger) > most) continue;
      box.copy(larger);
      kept.push(...part);
    }
    return kept;
  }

  _mainLink(joint) {
    const own = this._links.filter((l) => l.joint === joint);
    return own.reduce((best, l) => (!best || l.mesh.geometry.index.count > best.mesh.geometry.index.count ? l : best), null);
  }

  // ---------------------------------------------------------------- showing

  _move(groups, position) {
    this.scene.joints.forEach((joint, k) => move(groups.get(joint.name), joint, this._axes[k], position[k]));
  }

  _stage(k) {
    const { stage } = this._shown;
    return (stage && this.stages[stage[k]]) || UNKNOWN_STAGE;
  }

  // From a link's own colour towards its stage's: as far as the residual is near its threshold.
  _colour() {
    const { stage, level } = this._shown;
    this._weights = this.scene.joints.map((_, k) => {
      if (!stage) return 0;
      const { least = 0.6, most = 0.95 } = this._stage(k);
      return least + (most - least) * Math.min(level ? Math.abs(level[k]) : 0, 1);
    });
    for (const { joint, material, own } of this._links) {
      if (joint === null) continue;
      const k = this._index.get(joint);
      const colour = own.clone().lerp(new THREE.Color(this._stage(k).colour), this._weights[k]).convertSRGBToLinear();
      material.color.copy(colour);
      material.emissive.copy(colour).multiplyScalar(0.18 * this._weights[k]);
    }
  }

  // A joint's missing torque over the largest that it has.
  _share(k) {
    return this._shown.torque[k] / (this.torqueScale ? this.torqueScale[k] : Math.max(...this._shown.torque.map(Math.abs)));
  }

  // The missing torque: of the joint with the gravest stage; where all have the same, of the selected joint if there is one.
  _mark() {
    const { stage, level, torque } = this._shown;
    const alike = !stage || !stage.some((s) => s !== stage[0]), asked = alike ? this._selected : null;
    this._worst = null;
    const pushed = this._shown.attached && this._shown.attached.push; // the torque is that of the push, which is shown
    if (torque && asked !== null && !pushed) this._worst = this._index.get(asked);
    else if (torque && !pushed) {
      // The gravest stage, then the highest level, then the largest torque.
      const grave = torque.map((x, k) => 1e6 * (stage ? stage[k] : 0) + 1e2 * (level ? level[k] : 0) + this._share(k));
      const missing = [...torque.keys()].filter((k) => Math.abs(this._share(k)) > 0.02);
      if (missing.length) this._worst = missing.reduce((best, k) => (grave[k] > grave[best] ? k : best));
    }
    if (this._worst === null) {
      this._torque.hide();
      this._pin.hidden = true;
      return;
    }
    const k = this._worst, joint = this.scene.joints[k];
    this._torque.show(this._arm.get(joint.name), this._axes[k], joint.kind === "prismatic", this._share(k), this._ink);
    this._pin.hidden = false;
    const text = `${alike && asked === null && this.scene.joints.length > 1 ? "worst now: " : ""}${joint.short} ${torque[k] < 0 ? "−" : "+"}${Math.abs(torque[k]).toPrecision(3)} ${joint.unit}`;
    if (this._pin.textContent !== text) this._pin.textContent = text;
  }

  _say() {
    const gravest = this._shown.stage ? Math.max(...this._shown.stage) : -1;
    const stage = this.stages[gravest];
    const signs = this._attached.legend();
    const key = JSON.stringify([gravest, this._shown.label, this._selected, this.stages.length, signs]);
    if (key === this._said) return;
    this._said = key;
    const part = (name, text, colour) => {
      const node = Object.assign(document.createElement("span"), { className: "arm3d-" + name, textContent: text });
      if (colour) node.style.setProperty("--stage", colour);
      return node;
    };
    this._head.replaceChildren();
    if (stage && !stage.full) this._head.append(part("chip", stage.name, stage.colour), " ");
    if (this._shown.label) this._head.append(part("text", this._shown.label), " ");
    if (this._selected) this._head.append(part("picked", "selected: " + this._selected));
    const row = (name, colour, title, full) => {
      const item = Object.assign(document.createElement("li"), { title });
      if (full) item.append(name + ": 0", part("scale", "", colour), full);
      else item.append(part("dot", "", colour), name);
      return item;
    };
    this._legend.replaceChildren(
      ...this.stages.map((s) => row(s.name, s.colour, s.words || "", s.full)), ...signs.map(([name, colour]) => row(name, colour, "")));
  }

  // Put texts beside what they are about, one above the other where they would overlap.
  _placePins() {
    const { camera } = this.viewer, placed = [];
    if (!this._pin.hidden) {
      const at = this._arm.get(this.scene.joints[this._worst].name).getWorldPosition(new THREE.Vector3());
      const away = at.distanceTo(camera.getWorldPosition(new THREE.Vector3()));
      const beside = (this._torque.radius * this._pane.clientHeight) / (2 * Math.tan((0.5 * camera.fov * Math.PI) / 180) * away); // [px]
      this._place(this._pin, at.project(camera), 0.8 * beside, 1.2 * beside, placed);
    }
    this._attached.pins().forEach((pin, k) => {
      const tag = this._tags[k];
      tag.hidden = !pin;
      if (!pin) return;
      if (tag.textContent !== pin.words) tag.textContent = pin.words;
      this._place(tag, pin.at.project(camera), 10, 10, placed);
    });
  }

  // Put a text so far to the right of a projected point and above it [px], within the picture, and off other texts.
  _place(pin, at, right, above, placed) {
    const { clientWidth: w, clientHeight: h } = this._pane, { offsetWidth: wide, offsetHeight: tall } = pin;
    const inside = (x, low, high) => Math.round(Math.min(Math.max(x, low), high));
    const x = inside((0.5 + 0.5 * at.x) * w + right, 8, w - wide - 8);
    let y = inside((0.5 - 0.5 * at.y) * h - above - tall, 48, h - this._legend.offsetHeight - tall - 16);
    const meets = (o) => x < o.x + o.wide && o.x < x + wide && Math.abs(y - o.y) < tall + 4;
    for (let o; (o = placed.find(meets)); ) y = o.y - tall - 4;
    placed.push({ x, y, wide });
    pin.style.transform = `translate(${x}px, ${y}px)`;
  }

  // ---------------------------------------------------------------- the world around

  _applyTheme() {
    const dark = (this._theme || (this._dark.matches ? "dark" : "light")) === "dark";
    this.box.dataset.theme = dark ? "dark" : "light";
    this._ink = dark ? "#ffffff" : "#1c2126";
    this._ground.ink.copy(new THREE.Color(dark ? "#c8d4e0" : "#43505e"));
    for (const skin of this._ghostSkins) skin.color.copy(linear(dark ? "#b9d4ee" : "#5d7f9f"));
    this._mark();
    this.viewer.set_dirty();
  }

  _listen() {
    this._resize = new ResizeObserver(() => {
      this.viewer.set_3d_pane_size();
      if (!this._ownView) this.resetView();
    });
    this.viewer.controls.addEventListener("start", () => (this._ownView = true));
    this._resize.observe(this._pane);
    this._dark.addEventListener("change", this._retheme);
    this._onPrint = () => this.keepStill();
    addEventListener("beforeprint", this._onPrint);
    this.viewer.controls.enableZoom = this._zoom === "always";
    if (this._zoom !== "always") {
      this._pane.addEventListener("focus", () => (this.viewer.controls.enableZoom = true));
      this._pane.addEventListener("blur", () => (this.viewer.controls.enableZoom = false));
    }
    let pressed = null;
    this._pane.addEventListener("pointerdown", (e) => {
      pressed = [e.clientX, e.clientY];
      this._pane.focus({ preventScroll: true });
    });
    this._pane.addEventListener("pointerup", (e) => {
      if (!pressed || Math.hypot(e.clientX - pressed[0], e.clientY - pressed[1]) > 5) return;
      const joint = this.jointAt(e.clientX, e.clientY);
      this.select(joint);
      if (this.onSelect) this.onSelect(joint);
    });
    this._pane.addEventListener("dblclick", () => this.resetView());
  }

  // The joint whose link is seen at a point of the window; null for the base and for nothing.
  jointAt(x, y) {
    const area = this._pane.getBoundingClientRect();
    const point = new THREE.Vector2(((x - area.left) / area.width) * 2 - 1, 1 - ((y - area.top) / area.height) * 2);
    const ray = new THREE.Raycaster();
    this.viewer.scene.updateMatrixWorld(true);
    ray.setFromCamera(point, this.viewer.camera);
    const [hit] = ray.intersectObjects(this._links.map((l) => l.mesh), false);
    return hit ? hit.object.userData.joint : null;
  }
}
