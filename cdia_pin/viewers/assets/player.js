// `Player`: an arm's motion over time, with a bar to play, pause and seek; of a log, or of frames as they come.

const SPEEDS = [0.25, 0.5, 1, 2, 5];
const ICONS = { play: "M3 1 L13 7 L3 13 Z", pause: "M2 1 H5.5 V13 H2 Z M8.5 1 H12 V13 H8.5 Z" };
const STRIP_EVERY = 400; // [ms]
const LATE = 0.25; // [s], how far behind the newest frame a live picture may fall before it hurries

class Player {
  // arm: an `Arm3D`; timeline: `Timeline.to_dict()`, or {live: true, follow, stages} to be filled by `append`:
  // shown as frames come, or from the beginning if follow is false; reach, if given, are positions to come.
  constructor(arm, timeline) {
    this.arm = arm;
    this.live = Boolean(timeline.live);
    this.playing = false;
    this.speed = 1;
    this.time = 0;
    this.onTime = null;
    this.applied = 0; // frames shown so far
    this._data = { time: [], position: [], label: [] };
    this._variants = [{ name: timeline.name || "", ...pick(timeline) }, ...(timeline.variants || [])];
    this._variant = 0;
    this._follow = this.live && timeline.follow !== false;
    if (timeline.stages) arm.stages = timeline.stages;
    this._framed = Boolean(timeline.reach);
    if (this._framed) arm.frame(sparse(timeline.reach));
    this._build();
    if (timeline.time) this.append(timeline);
    this._last = performance.now();
    this._stripAt = -Infinity;
    this._tick = (now) => {
      this._request = requestAnimationFrame(this._tick);
      this._advance(Math.min((now - this._last) / 1000, 0.5));
      this._last = now;
      if (this._stripIsOld && now - this._stripAt > STRIP_EVERY) this._paintStrip();
    };
    this._request = requestAnimationFrame(this._tick);
  }

  get begin() { return this._data.time.length ? this._data.time[0] : 0; }
  get end() { return this._data.time.length ? this._data.time[this._data.time.length - 1] : 0; }

  // Add frames after those that are there: the fields of a timeline.
  append(chunk) {
    const first = this._data.time.length === 0, follow = this._follow;
    for (const [key, rows] of Object.entries(chunk)) {
      if (Array.isArray(rows) && TRACKS.includes(key)) (this._data[key] = this._data[key] || []).push(...rows);
    }
    for (const row of chunk.torque || []) {
      this._largest = row.map((x, k) => Math.max(Math.abs(x), this._largest ? this._largest[k] : 1e-9));
    }
    this.arm.torqueScale = this._largest || null;
    this._seek.min = this.begin;
    this._seek.max = this.end;
    this._stripIsOld = true;
    if (first && this._data.time.length) {
      if (!this._framed) this.arm.frame(sparse(this._data.position));
      this.seek(this.begin);
      if (this.live) {
        this._follow = follow;
        this.play();
      }
    }
  }

  play() {
    if (!this._data.time.length) return;
    if (!this.live && this.time >= this.end) this.seek(this.begin);
    this.playing = true;
    this._showButton();
  }

  pause() {
    this.playing = false;
    this._follow = false;
    this._showButton();
  }

  seek(time) {
    this.time = Math.min(Math.max(time, this.begin), this.end);
    this._follow = this.live && this.time >= this.end;
    this._show();
  }

  // No more frames will come.
  finish() {
    this.live = this._follow = false;
  }

  // Show another model's residuals over the same motion.
  show(variant) {
    this._variant = variant;
    [...this._choice.children].forEach((b, k) => b.setAttribute("aria-pressed", String(k === variant)));
    this._paintStrip();
    this._show();
  }

  dispose() {
    cancelAnimationFrame(this._request);
    this.bar.remove();
  }

  // ---------------------------------------------------------------- time

  _advance(passed) {
    if (!this.playing || !this._data.time.length) return;
    let next = this.time + passed * this.speed;
    if (this._follow && this.end - next > LATE) next = this.end - 0.1;
    if (next >= this.end) {
      next = this.end;
      if (!this.live) this.pause();
    }
    if (next !== this.time) {
      this.time = next;
      this._show();
    }
  }

  _at(time) { // index of the last frame not after a time
    const t = this._data.time;
    let low = 0, high = t.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (t[middle] <= time) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  _show() {
    const d = this._data;
    if (!d.time.length) return;
    const k = this._at(this.time), next = Math.min(k + 1, d.time.length - 1);
    const share = next > k ? Math.min(Math.max((this.time - d.time[k]) / (d.time[next] - d.time[k]), 0), 1) : 0;
    const between = (rows) => rows[k].map((x, j) => x + share * (rows[next][j] - x));
    const chosen = this._variant ? this._variants[this._variant] : d;
    const at = (rows) => (rows && rows[k]) || null;
    const newest = (rows) => (rows || []).filter(([t]) => t <= this.time + 1e-9).map((row) => row[1]).pop();
    this.arm.pose(between(d.position), {
      desired: d.desired ? between(d.desired) : null,
      stage: at(chosen.stage), level: at(chosen.level), torque: at(chosen.torque),
      label: newest(chosen.label) || "", attached: newest(chosen.attached) || null,
    });
    this.applied += 1;
    this._seek.value = this.time;
    this._clock.textContent = `${this.time.toFixed(1)} / ${this.end.toFixed(1)} s`; // the log's own time, as in charts and tables
    this._seek.setAttribute("aria-valuetext", `${this.time.toFixed(1)} seconds`);
    if (this.onTime) this.onTime(this.time);
  }

  // ---------------------------------------------------------------- the bar

  _build() {
    const make = (tag, name, attributes = {}) => {
      const node = document.createElement(tag);
      node.className = "arm3d-" + name;
      for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
      return node;
    };
    this.bar = make("div", "bar", { role: "group", "aria-label": "Player" });
    this._button = make("button", "play", { type: "button" });
    this._button.addEventListener("click", () => (this.playing ? this.pause() : this.play()));
    this._seek = make("input", "slider", { type: "range", min: 0, max: 0, step: "any", value: 0, "aria-label": "Time" });
    this._seek.addEventListener("input", () => this.seek(Number(this._seek.value)));
    this._strip = make("div", "strip");
    const seek = make("div", "seek");
    seek.append(this._strip, this._seek);
    this._clock = make("span", "time");
    const speed = make("select", "speed", { "aria-label": "Speed" });
    for (const s of SPEEDS) speed.append(new Option(s + "×", s, s === 1, s === 1));
    speed.addEventListener("change", () => (this.speed = Number(speed.value)));
    this._choice = make("div", "variants", { role: "group", "aria-label": "Model" });
    if (this._variants.length > 1) {
      this._choice.append(...this._variants.map((v, k) => {
        const b = Object.assign(make("button", "variant", { type: "button", "aria-pressed": String(k === 0) }), { textContent: v.name });
        b.addEventListener("click", () => this.show(k));
        return b;
      }));
    }
    this.bar.append(this._button, seek, this._clock, ...(this._variants.length > 1 ? [this._choice] : []), speed);
    this.arm.box.append(this.bar);
    this.arm.box.addEventListener("keydown", (e) => this._key(e), true);
    this._showButton();
  }

  _key(event) {
    const inForm = event.target.tagName === "SELECT" || (event.target.tagName === "BUTTON" && event.key === " ");
    if (inForm || event.ctrlKey || event.altKey || event.metaKey) return;
    const step = event.shiftKey ? 5 : 1;
    const actions = {
      " ": () => (this.playing ? this.pause() : this.play()),
      ArrowLeft: () => this.seek(this.time - step), ArrowRight: () => this.seek(this.time + step),
      Home: () => this.seek(this.begin), End: () => this.seek(this.end),
    };
    if (!actions[event.key]) return;
    actions[event.key]();
    event.preventDefault();
    event.stopPropagation();
  }

  _showButton() {
    this.arm.moving = this.playing;
    const name = this.playing ? "pause" : "play";
    if (this._button.dataset.shows === name) return;
    this._button.dataset.shows = name;
    this._button.setAttribute("aria-label", name === "play" ? "Play" : "Pause");
    this._button.innerHTML = `<svg viewBox="0 0 14 14" aria-hidden="true"><path d="${ICONS[name]}"/></svg>`;
  }

  // The gravest stage of any joint over the time, above the slider.
  _paintStrip() {
    this._stripIsOld = false;
    this._stripAt = performance.now();
    const chosen = this._variant ? this._variants[this._variant] : this._data;
    const { time } = this._data, { stages } = this.arm;
    const whole = this.end - this.begin;
    if (!chosen.stage || !whole) return this._strip.replaceChildren();
    const pieces = [];
    chosen.stage.forEach((row, k) => {
      const gravest = Math.max(...row), last = pieces[pieces.length - 1];
      if (last && last.stage === gravest) last.to = time[k];
      else {
        if (last) last.to = time[k];
        pieces.push({ stage: gravest, from: time[k], to: time[k] });
      }
    });
    this._strip.replaceChildren(...pieces.filter((p) => stages[p.stage] && stages[p.stage].least > 0).map((p) => {
      const i = document.createElement("i");
      i.style.left = (100 * (p.from - this.begin)) / whole + "%";
      i.style.width = (100 * (p.to - p.from)) / whole + "%";
      i.style.background = stages[p.stage].colour;
      i.title = stages[p.stage].name;
      return i;
    }));
  }
}

const TRACKS = ["time", "position", "desired", "stage", "level", "torque", "label", "attached"];
const sparse = (rows) => rows.filter((_, k) => k % Math.max(1, Math.floor(rows.length / 40)) === 0);
const pick = (timeline) => Object.fromEntries(Object.entries(timeline).filter(([key]) => TRACKS.includes(key)));
