// The report of a monitor's run, from the data in the page.

const STAGES = DATA.stages;
for (const [name, s] of Object.entries(STAGES)) document.documentElement.style.setProperty("--stage-" + name, s.colour);
const EVENT = { detection: "detected", isolation: "isolated", accommodation: "accommodated", idle: "idle" }; // stage → its colour
const stageOf = (e) => EVENT[e.stage.split(", ").pop()];
const of = (j) => DATA.events.map((e, k) => ({ ...e, number: k + 1 })).filter((e) => e.concerned.includes(j.name));
const time = (t) => t.toFixed(3) + "\u00a0s";
const SHOWN = { stages: STAGES, begin: DATA.begin, end: DATA.end, clock };
const named = (p) => p.effect + ": " + p.name;

// ---------------------------------------------------------------- head

function head() {
  const fact = (label, ...value) => h("li", {}, label + " ", value);
  const r = DATA.record, blind = DATA.joints.some((j) => j.blind), found = DATA.events.some((e) => e.stage === "detection");
  return h("header", {},
    h("h1", {}, DATA.title),
    h("ul", { class: "facts" },
      fact("Robot", h("b", {}, DATA.robot)),
      r.log ? fact("Log", h("b", {}, r.log.source)) : null,
      fact("Watched", h("b", {}, num(DATA.duration, 4) + " s")),
      fact("Engine", h("b", {}, DATA.engine)),
      fact("Known effects", h("b", {}, r.bank.map((b) => b.replaceAll("_", " ")).join(", "))),
      fact("Thresholds from", h("b", {}, r.healthy.length ? plural(r.healthy.length, "healthy run") : "the user")),
      fact("cdia-pin", h("b", {}, DATA.version))),
    DATA.command ? h("pre", {}, h("code", {}, DATA.command)) : null,
    h("section", { class: "card verdict" }, h("div", {},
      h("span", { class: "chip " + (found || blind ? "warn" : "good") }, found ? "a change was detected" : "nothing was detected"),
      h("p", { class: "first" }, DATA.summary), DATA.notes.map((n) => h("p", { class: "soft" }, n)))));
}

// ---------------------------------------------------------------- stages of all joints over time

function stages() {
  const seen = Object.keys(STAGES).filter((s) => DATA.joints.some((j) => j.stages.some((i) => i[2] === s)));
  return h("section", {}, h("h2", {}, "Stages"),
    h("p", { class: "lead" }, "The stage of each joint over time, from healthy to compensated."),
    h("div", { class: "card" },
      legend(...seen.map((s) => ["stage-" + s, "band", s + (STAGES[s].words && ": " + STAGES[s].words)]),
        DATA.joints.some((j) => j.present.length) && ["ink", "thin", "the fault is in the plant"]),
      JointCharts.stages(DATA.joints, SHOWN)));
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
  return h("section", {}, h("h2", {}, "Events"),
    h("p", { class: "lead" }, "Sizes with their 95 % interval, as they were estimated at that moment. Numbers stand at the dashed lines of the charts."),
    h("div", { class: "card" }, table([right("th", ""), right("th", "time"), "joint", "stage", "said"], rows)));
}

function believed() {
  const last = (j) => j.stages[j.stages.length - 1][2];
  const stage = (name) => h("span", { class: "dot", style: "background:var(--stage-" + name + ")" });
  const faults = (said) => h("td", {}, said.length ? said.map((b) => h("div", {}, h("b", {}, b))) : h("span", { class: "soft" }, "–"));
  const rows = DATA.joints.map((j) => [j.name, right("td", withUnit(j.usual, j.units.residual)), right("td", j.share), right("td", num(100 * j.nearness, 3) + "\u00a0%"),
    h("td", {}, stage(last(j)), last(j), j.blind ? h("b", {}, ", blind") : null), faults(j.believed)]);
  const arm = DATA.arm, none = () => right("td", "–", "soft");
  if (arm) rows.push([h("b", {}, arm.name), none(), none(), none(), h("td", {}, stage(arm.stage), arm.stage), faults(arm.believed)]);
  return h("section", {}, h("h2", {}, "At the end"),
    h("p", { class: "lead" }, "A threshold depends on the state: the typical one is shown, and the largest residual over its threshold of that moment. Thresholds also as a share of the RMS torque of healthy motion. Above 30 % a joint is blind. The last row is that of the whole arm: payload, tilt of the base, contact."),
    h("div", { class: "card" }, table(["joint", right("th", "typical threshold"), right("th", "of torque"), right("th", "largest residual over its threshold"), "stage", "fault, ± 95 %"], rows)));
}

function tracking() {
  if (!DATA.tracking) return null;
  const runs = Object.entries(DATA.tracking.runs);
  const style = { faulty: "b", accommodated: "a" };
  const cell = (name, x, j) => right("td", x === null ? "diverged" : num(1e3 * x) + "\u00a0m" + j.units.position, style[name] || "");
  const rows = DATA.joints.map((j, k) => [j.name, ...runs.map(([name, rms]) => cell(name, rms[k], j))]);
  return h("section", {}, h("h2", {}, "Tracking"),
    h("p", { class: "lead" }, "RMS of position less desired position" + (DATA.tracking.since > 0 ? " from " + num(DATA.tracking.since) + " s on, when the first fault begins." : ".")),
    h("div", { class: "card" }, table(["joint", ...runs.map(([name]) => right("th", name, style[name] || ""))], rows)));
}

// ---------------------------------------------------------------- one joint

function signals(j) {
  const boxes = [0, 1, 2].map(() => h("div", { class: "chart" })), unit = j.units.residual;
  const inside = Object.keys(STAGES).filter((s) => s !== "healthy" && j.stages.some((i) => i[2] === s));
  const torques = unit === j.units.load;
  const shown = { ...SHOWN, marks: of(j).map((e) => ({ time: e.time, text: String(e.number) })) };
  return {
    node: h("div", { class: "card stack" },
      inside.length ? legend(...inside.map((s) => ["stage-" + s, "band faint", s]), ["ink", "dotted", "event, with its number"]) : null,
      h("h3", {}, j.name + ": " + (torques ? "residual" : "velocity error of the observer") + " and its threshold"), boxes[0],
      h("h3", {}, j.name + (torques ? ": measured and modelled torque" : ": torque")), boxes[1],
      j.error ? [h("h3", {}, j.name + ": tracking error q − q_d"), boxes[2]] : null,
      h("div", { class: "soft small" }, hint(ZOOM))),
    draw() {
      JointCharts.residual(boxes[0], j, shown);
      JointCharts.torque(boxes[1], j, shown);
      if (j.error) JointCharts.tracking(boxes[2], j, shown);
    },
  };
}

function againstMotion(j) {
  if (!j.against) return null;
  const names = Object.keys(j.against.signals), boxes = names.map(() => h("div", { class: "chart" }));
  const curve = names.some((s) => j.against.signals[s].curve);
  return {
    node: h("div", { class: "stack" },
      legend(["before", "dots", "residual from the detection on"], ["measured", "dots", "before, and after the fault was gone"],
        curve && ["curve", "dashed", "torque of the fault isolated last: " + j.against.fitted.join(" with ")]),
      h("div", { class: "three-up" }, names.map((s, k) => h("div", { class: "card" }, h("h3", {}, j.name + ": residual against " + (s === "load" ? "torque" : s)), boxes[k])))),
    draw() { names.forEach((s, k) => JointCharts.faulty(boxes[k], j, s)); },
  };
}

function isolation(j) {
  if (!j.hypotheses.length) return null;
  return h("div", { class: "card stack" },
    h("h3", {}, j.name + ": the hypotheses over time"),
    legend(["floor", "band faint", "open: detected, nothing excluded yet"], ["after", "band", "leading: in the combination that explains best"],
      ["after", "band faint", "possible: in another one that explains the same"]),
    JointCharts.hypotheses(j, SHOWN));
}

function sizes(j) {
  const boxes = j.parameters.map(() => h("div", { class: "chart" }));
  if (!boxes.length) return null;
  return {
    node: h("div", { class: "stack" },
      legend(["after", "line", "parameter as estimated"], ["after", "band faint", "its 95 % interval"], j.parameters.some((p) => p.real !== null) && ["floor", "dashed", "its value in the plant"]),
      h("div", { class: "two-up" }, j.parameters.map((p, k) => h("div", { class: "card" }, h("h3", {}, j.name + ", " + named(p)), boxes[k])))),
    draw() { j.parameters.forEach((p, k) => JointCharts.parameter(boxes[k], j, p, SHOWN)); },
  };
}

function mostTelling() {
  const worst = DATA.joints.map((j) => [of(j).length ? 1 : 0, j.nearness]);
  return DATA.joints[worst.reduce((best, w, k) => (w[0] > worst[best][0] || (w[0] === worst[best][0] && w[1] > worst[best][1]) ? k : best), 0)].name;
}

const buttons = () => jointButtons((j) => num(j.nearness, 2) + " × threshold");

function joints() {
  if (!DATA.joints.some((j) => j.hypotheses.length || j.parameters.length || j.against)) return null;
  const nothing = (j) => h("p", { class: "card soft" }, j.name + " was healthy all the time: there was nothing to decide.");
  return h("section", {}, h("h2", {}, "What it is, and how large"),
    h("p", { class: "lead" }, "Which known effects explain the residual of a joint, their parameters as they were estimated, and the residual against the motion."),
    buttons(), ofJoint((j) => {
      const parts = [isolation(j), sizes(j), againstMotion(j)].filter(Boolean);
      return parts.length ? parts : [nothing(j)];
    }));
}

// ---------------------------------------------------------------- record

function record() {
  const text = (v) => (Array.isArray(v) ? (v.length ? v.map((x) => h("div", {}, text(x))) : "none")
    : v !== null && typeof v === "object" ? Object.entries(v).map(([k, x]) => h("div", {}, k.replaceAll("_", " ") + ": ", text(x))) : typeof v === "number" ? String(+v.toPrecision(5)) : v === null || v === "" ? "–" : String(v));
  return h("section", {}, h("h2", {}, "How it was made"),
    h("details", {}, h("summary", {}, "Engine, settings and healthy runs"),
      h("div", {}, table(null, Object.entries(DATA.record).map(([k, v]) => [h("td", { class: "soft", style: "width:24%" }, k.replaceAll("_", " ")), h("td", {}, text(v))])))),
    h("details", {}, h("summary", {}, "Words used on this page"), h("div", {},
      h("p", {}, "Residual: the torque that the model lacks to explain the motion, through a filter that needs no accelerations. Beyond its threshold no healthy run has been. A joint is blind where the threshold exceeds 30 % of the RMS torque of healthy motion. Modelled torque: measured torque plus residual."),
      h("p", {}, "Isolation: every combination of the known effects is tested against the residual since the detection. Accommodation: the control torque compensates the isolated fault. Idle: the fault is cleared, for its torque is absent where it would show; it is kept in memory and no longer compensated."))));
}

const LEAD = "Replays the run. A link takes the colour of its joint's stage, the stronger the farther its residual"
  + (DATA.joints[0].error ? "; the faint arm is where it should be" : "") + ".";

show([head(), motion(LEAD, buttons(), (j) => [signals(j)]), stages(), events(), believed(), tracking(), joints(), record(),
  h("footer", {}, "Made by cdia-pin " + DATA.version + ". One file, no network; charts by uPlot (MIT).")]);
chosen.choose(mostTelling());
