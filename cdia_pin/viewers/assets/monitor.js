// The report of a monitor's run, from the data in the page.

const STAGES = DATA.stages;
for (const [name, s] of Object.entries(STAGES)) document.documentElement.style.setProperty("--stage-" + name, s.colour);
const EVENT = { detection: "detected", isolation: "isolated", accommodation: "accommodated", idle: "idle" }; // stage → its colour
const stageOf = (e) => EVENT[e.stage.split(", ").pop()];
const of = (j) => DATA.events.map((e, k) => ({ ...e, number: k + 1 })).filter((e) => e.concerned.includes(j.name));
const time = (t) => t.toFixed(3) + "\u00a0s";

// ---------------------------------------------------------------- head

function head() {
  const fact = (label, ...value) => h("li", {}, label + " ", value);
  const r = DATA.record, found = DATA.events.some((e) => e.stage === "detection");
  return h("header", {},
    h("h1", {}, DATA.title),
    h("ul", { class: "facts" },
      fact("Robot", h("b", {}, DATA.robot)),
      r.log ? fact("Log", h("b", {}, r.log.source)) : null,
      fact("Watched", h("b", {}, num(DATA.end - DATA.begin, 4) + " s")),
      fact("Engine", h("b", {}, DATA.engine)),
      fact("Known effects", h("b", {}, r.bank.map((b) => b.replaceAll("_", " ")).join(", "))),
      fact("Thresholds from", h("b", {}, r.healthy.length ? plural(r.healthy.length, "healthy run") : "the user")),
      fact("cdia-pin", h("b", {}, DATA.version))),
    DATA.command ? h("pre", {}, h("code", {}, DATA.command)) : null,
    h("section", { class: "card verdict" }, h("div", {},
      h("span", { class: "chip " + (found ? "warn" : "good") }, found ? "a change was detected" : "nothing was detected"),
      h("p", { class: "first" }, DATA.summary), DATA.notes.map((n) => h("p", { class: "soft" }, n)))));
}

// ---------------------------------------------------------------- stages of all joints over time

function stages() {
  const seen = Object.keys(STAGES).filter((s) => DATA.joints.some((j) => j.stages.some((i) => i[2] === s)));
  const place = (t) => (100 * (t - DATA.begin)) / (DATA.end - DATA.begin);
  const strip = (j) => h("div", { class: "strip", role: "img", "aria-label": j.name + ": " + j.stages.map((i) => i[2] + " from " + num(i[0], 4) + " s").join(", ") },
    j.stages.map(([from, to, stage]) => h("i", { class: stage === "healthy" ? "calm" : "",
      title: stage + ", " + time(from) + " to " + time(to), style: `left:${place(from)}%;width:${place(to) - place(from)}%;background:var(--stage-${stage})` })));
  const ticks = [0, 0.25, 0.5, 0.75, 1].map((s) => h("span", {}, num(DATA.begin + s * (DATA.end - DATA.begin), 4) + " s"));
  return h("section", {}, h("h2", {}, "Stages"),
    h("p", { class: "lead" }, "Where each joint stands between healthy and corrected, over time."),
    h("div", { class: "card" },
      legend(...seen.map((s) => ["stage-" + s, "band", s + (STAGES[s].words && ": " + STAGES[s].words)])),
      h("div", { class: "strips" }, DATA.joints.map((j) => [h("span", {}, j.short), strip(j)]), h("span", {}), h("div", { class: "ticks" }, ticks))));
}

// ---------------------------------------------------------------- tables

function events() {
  if (!DATA.events.length) return null;
  const rows = DATA.events.map((e, k) => [
    right("td", String(k + 1), "soft"), right("td", time(e.time)), h("td", {}, e.joints),
    h("td", {}, h("span", { class: "dot", style: "background:var(--stage-" + stageOf(e) + ")" }), e.stage),
    h("td", {}, e.verdict ? h("div", { class: "soft" }, e.verdict) : null,
      e.said.map((s) => h("div", {}, h("b", {}, s))),
      e.alternatives.length ? h("div", {}, "or else " + e.alternatives.join("; ")) : null,
      e.reason ? h("div", { class: "soft" }, e.reason) : e.stage === "detection" ? "the residual left its threshold" : null)]);
  return h("section", {}, h("h2", {}, "What was said"),
    h("p", { class: "lead" }, "Sizes with their 95 % interval, as they were believed at that moment. Numbers stand at the dashed lines of the charts."),
    h("div", { class: "card" }, table([right("th", ""), right("th", "time"), "joint", "stage", "said"], rows)));
}

function believed() {
  const rows = DATA.joints.map((j) => [j.name, right("td", withUnit(j.usual, j.units.residual)), right("td", withUnit(j.largest, j.units.residual)),
    h("td", {}, h("span", { class: "dot", style: "background:var(--stage-" + j.stages[j.stages.length - 1][2] + ")" }), j.stages[j.stages.length - 1][2]),
    h("td", {}, j.believed.length ? j.believed.map((b) => h("div", {}, h("b", {}, b))) : h("span", { class: "soft" }, "–"))]);
  return h("section", {}, h("h2", {}, "At the end"),
    h("div", { class: "card" }, table(["joint", right("th", "threshold"), right("th", "largest residual"), "stage", "believed, ± 95 %"], rows)));
}

function tracking() {
  if (!DATA.tracking) return null;
  const runs = Object.entries(DATA.tracking.runs);
  const style = { faulty: "b", accommodated: "a" };
  const cell = (name, x, j) => right("td", x === null ? "ran away" : num(1e3 * x) + "\u00a0m" + j.units.position, style[name] || "");
  const rows = DATA.joints.map((j, k) => [j.name, ...runs.map(([name, rms]) => cell(name, rms[k], j))]);
  return h("section", {}, h("h2", {}, "Tracking"),
    h("p", { class: "lead" }, "RMS of position less desired position" + (DATA.tracking.since > 0 ? " from " + num(DATA.tracking.since) + " s on, when the first fault begins." : ".")),
    h("div", { class: "card" }, table(["joint", ...runs.map(([name]) => right("th", name, style[name] || ""))], rows)));
}

// ---------------------------------------------------------------- one joint

function shade(j) {
  return (u) => {
    const { left, top, width, height } = u.bbox;
    const x = (t) => Math.min(Math.max(u.valToPos(t, "x", true), left), left + width);
    for (const [from, to, stage] of j.stages) {
      if (stage === "healthy" || x(to) <= x(from)) continue;
      u.ctx.fillStyle = alpha(STAGES[stage].colour, 0.2);
      u.ctx.fillRect(x(from), top, x(to) - x(from), height);
    }
  };
}

function marks(j) {
  return (u) => {
    const c = u.ctx, px = devicePixelRatio, { left, top, width, height } = u.bbox;
    c.save();
    c.beginPath(); c.rect(left, top, width, height); c.clip();
    c.strokeStyle = c.fillStyle = color("ink"); c.lineWidth = px; c.setLineDash([4 * px, 4 * px]);
    c.font = 11 * px + "px " + getComputedStyle(document.body).fontFamily;
    c.textBaseline = "top"; c.textAlign = "left";
    let free = -Infinity, level = 0; // labels that would overlap stand on lines of their own
    for (const e of of(j)) {
      const x = u.valToPos(e.time, "x", true);
      level = x < free ? level + 1 : 0;
      c.beginPath(); c.moveTo(x, top); c.lineTo(x, top + height); c.stroke();
      c.fillText(String(e.number), x + 3 * px, top + (2 + 12 * level) * px);
      free = x + 18 * px;
    }
    c.restore();
  };
}

function oneJoint(j) {
  const value = (unit) => (u, v) => (v === null || v === undefined ? "–" : withUnit(v, unit));
  const line = (label, name, width, unit, more = {}) => ({ label, stroke: color(name), width, value: value(unit), points: { show: false }, ...more });
  const options = (label, series, scale) => ({
    scales: { x: { time: false, range: (u, low, high) => [low, high] }, y: scale || {} }, padding: [8, 12, 0, 0],
    legend: { markers: { width: 0, fill: (u, k) => u.series[k].stroke(u, k) } },
    hooks: { drawClear: [shade(j)], draw: [marks(j)] },
    cursor: { sync: { key: "joint-" + j.name }, points: { size: 7 } },
    axes: [axis("time [s]", { values: axisNumber }), axis(label, { size: 62, values: axisNumber })],
    series: [{ label: "time", value: (u, v) => (v === null ? "–" : num(v, 5) + " s") }, ...series],
  });
  const boxes = [0, 1, 2].map(() => h("div", { class: "chart" }));
  const unit = j.units.residual, corrected = j.correction.some((x) => x);
  const inside = Object.keys(STAGES).filter((s) => s !== "healthy" && j.stages.some((i) => i[2] === s));
  const symbol = unit === j.units.load ? "residual, the torque that the model lacks" : "velocity error of the observer";
  return {
    node: h("div", { class: "card stack" },
      inside.length ? legend(...inside.map((s) => ["stage-" + s, "band faint", s]), ["ink", "dotted", "event, with its number"]) : null,
      h("h3", {}, j.name + ": " + symbol + ", and ± its threshold"), boxes[0],
      h("h3", {}, j.name + ": torque, and what is added to the nominal one"), boxes[1],
      j.error ? [h("h3", {}, j.name + ": tracking error q − q_d"), boxes[2]] : null,
      h("div", { class: "soft", style: "font-size:13px" }, "Drag across a chart to zoom, double-click to go back.")),
    draw() {
      const t = j.time, bound = (more) => line("± threshold", "floor", 1.5, unit, { dash: [6, 3], ...more });
      const most = Math.max(...j.residual.map(Math.abs), ...j.threshold) * 1.06;
      chart(boxes[0], 260, options("[" + unit + "]", [line("residual", "after", 1.5, unit), bound(), bound({ label: "lower", class: "hidden" })], { range: [-most, most] }),
        [t, j.residual, j.threshold, j.threshold.map((x) => -x)]);
      chart(boxes[1], 230, options("[" + j.units.load + "]", [line("torque", "measured", 2, j.units.load), ...(corrected ? [line("correction", "before", 1.5, j.units.load)] : [])]),
        [t, j.effort, ...(corrected ? [j.correction] : [])]);
      if (j.error) chart(boxes[2], 200, options("[m" + j.units.position + "]", [line("tracking error", "curve", 1.5, "m" + j.units.position)]), [t, j.error.map((x) => (x === null ? null : 1e3 * x))]);
    },
  };
}

function joints() {
  const worst = DATA.joints.map((j) => [of(j).length ? 1 : 0, j.largest / (j.usual || 1e-12)]);
  const first = worst.reduce((best, w, k) => (w[0] > worst[best][0] || (w[0] === worst[best][0] && w[1] > worst[best][1]) ? k : best), 0);
  const choice = picker(first, (j) => num(j.largest / (j.usual || 1e-12), 2) + " × threshold", (j) => [oneJoint(j)]);
  return { node: h("section", {}, h("h2", {}, "Joint by joint"), choice.node), draw: choice.draw };
}

// ---------------------------------------------------------------- record

function record() {
  const text = (v) => (Array.isArray(v) ? (v.length ? v.map((x) => h("div", {}, text(x))) : "none")
    : v !== null && typeof v === "object" ? Object.entries(v).map(([k, x]) => h("div", {}, k.replaceAll("_", " ") + ": ", text(x))) : typeof v === "number" ? String(+v.toPrecision(5)) : v === null || v === "" ? "–" : String(v));
  return h("section", {}, h("h2", {}, "How it was made"),
    h("details", {}, h("summary", {}, "Engine, settings and healthy runs"),
      h("div", {}, table(null, Object.entries(DATA.record).map(([k, v]) => [h("td", { class: "soft", style: "width:24%" }, k.replaceAll("_", " ")), h("td", {}, text(v))])))),
    h("details", {}, h("summary", {}, "Words used on this page"), h("div", {},
      h("p", {}, "Residual: what the model lacks to explain the motion, through a filter that needs no accelerations. Beyond its threshold no healthy run has been."),
      h("p", {}, "Isolation: every combination of the known effects is asked whether it explains the residual since the detection. Accommodation: the torque is corrected by what is believed. Idle: a fault whose torque stays away where it would show is no longer corrected for, but remembered."))));
}

show(() => [head(), stages(), events(), believed(), tracking(), joints(), record(),
  h("footer", {}, "Made by cdia-pin " + DATA.version + ". One file, no network; charts by uPlot (MIT).")]);
