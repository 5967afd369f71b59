// The report of a comparison or a discovery, from the data in the page.

const FOUND = DATA.discovery;
const IMPROVED = DATA.joints.some((j) => j.after);
// A joint without torque has no share of it.
const over = (rms, torque) => (torque > 0 && rms !== null ? rms / torque : null);
const share = (j, rms) => over(rms, j.torque_rms);

function mostTelling() {
  const gains = DATA.joints.map((j) => (j.rests ? -Infinity : share(j, j.before.rms) - (j.after ? share(j, j.after.rms) : 0)));
  return DATA.joints[gains.indexOf(Math.max(...gains))].name;
}

// ---------------------------------------------------------------- head and verdict

function head() {
  const logs = DATA.logs;
  const name = (l) => [h("b", {}, l.source), l.sha256 ? " (sha256 " + l.sha256.slice(0, 12) + "…)" : ""];
  const rates = [...new Set(logs.map((l) => num(l.log_rate) + " Hz"))].join(", ");
  const cutoffs = [...new Set(logs.map((l) => num(l.cutoff) + " Hz"))].join(", ");
  const fact = (label, ...value) => h("li", {}, label + " ", value);
  return h("header", {},
    h("h1", {}, DATA.title),
    h("ul", { class: "facts" },
      fact("Robot", h("b", {}, DATA.robot)),
      logs.map((l) => fact("Log", name(l))),
      DATA.holdout.map((l) => fact("Held-out log", name(l))),
      fact("Compared", h("b", {}, num(DATA.duration) + " s"), ", " + DATA.samples + " independent samples"),
      fact("Recorded at", h("b", {}, rates)),
      fact("Filtered at", h("b", {}, cutoffs)),
      fact("Model as given", h("b", {}, DATA.given.length ? "URDF + " + DATA.given.join(" + ") : "URDF alone")),
      fact("cdia-pin", h("b", {}, DATA.version))),
    DATA.command ? h("pre", {}, h("code", {}, DATA.command)) : null);
}

const CHIPS = {
  "nothing-missing": ["good", "nothing is missing"],
  explained: ["good", "explained down to the noise"],
  "explained-in-practice": ["good", "explained in practice"],
  unexplained: ["warn", "not explained yet"],
};

function verdict() {
  const before = mean(DATA.joints.map((j) => share(j, j.before.rms)).filter((s) => s !== null));
  if (!FOUND) {
    const worst = [...DATA.joints].sort((x, y) => share(y, y.before.rms) - share(x, x.before.rms))[0];
    const r = DATA.regions.before[0];
    return h("section", { class: "card verdict" }, h("div", {},
      DATA.changes.map((c) => h("p", { class: "first" }, c.sentence)),
      h("p", { class: DATA.changes.length ? "" : "first" }, "The model differs from the measured torque by " + percent(before) + " (mean over the joints), most on "
        + worst.name + " (" + percent(share(worst, worst.before.rms)) + ")."),
      r ? h("p", {}, "It is farthest from its own mean error " + regionWords(r) + ".") : null,
      h("p", { class: "soft" }, "Which physical effect is missing is what ", h("code", {}, "cdia discover"), " finds out, with the same log and robot.")));
  }
  const [style, label] = CHIPS[FOUND.verdict] || ["warn", FOUND.verdict];
  const last = FOUND.trace[FOUND.trace.length - 1];
  const numbers = FOUND.trace.length > 1
    ? h("div", { class: "numbers" }, h("span", {}, percent(FOUND.trace[0].mean)), h("span", { class: "arrow" }, "→"), h("span", {}, percent(last.mean)))
    : h("div", { class: "numbers" }, h("span", { class: "soft" }, percent(FOUND.trace[0].mean)));
  return h("section", { class: "card verdict" },
    h("div", {},
      h("span", { class: "chip verdict-chip " + style }, label),
      h("dl", { class: "answer" }, FOUND.answer.slice(1).map((l) => [h("dt", {}, l.head), h("dd", {}, l.text)])),
      h("details", { class: "plain" }, h("summary", {}, "The same in sentences"), h("div", {}, FOUND.sentences.map((s) => h("p", {}, s))))),
    h("div", { class: "fall" }, numbers,
      h("small", {}, "error, share of the torque RMS,"), h("small", {}, "mean over the joints"),
      h("small", {}, (FOUND.trace.length > 1 ? "held out " + percent(last.heldout_mean) + " · " : "") + "noise floor " + percent(FOUND.floor_mean))));
}

// ---------------------------------------------------------------- what changed between logs

function changed(c) {
  const growth = c.changes.some((x) => x.growth);
  const rows = c.changes.map((x) => [
    h("td", {}, h("b", {}, x.name), h("div", { class: "soft" }, x.where)),
    h("td", {}, x.differences.map((d) => h("div", {}, d))),
    ...(growth ? [right("td", x.growth || "–")] : []),
    right("td", x.torque), h("td", {}, markOf(x.confidence))]);
  const heads = ["changed", "difference ± 95 %", ...(growth ? [right("th", "of before")] : []), right("th", "largest torque"), "confidence"];
  return [DATA.changes.length > 1 ? h("p", { class: "lead" }, c.sentence) : null,
    rows.length ? h("div", { class: "card" }, table(heads, rows)) : null,
    h("div", { style: "margin-top:14px" }, [...c.doubts, ...c.notes].map((s) => h("p", { class: "soft" }, s)))];
}

function changes() {
  if (!DATA.changes.length) return null;
  return h("section", {}, h("h2", {}, "What changed"), DATA.changes.map(changed),
    DATA.changes.some((c) => c.changes.length) ? h("p", { class: "small soft" }, "Largest torque: RMS in the logs that have the change. A difference acts on the arm: the measured torque changes by the opposite.") : null);
}

function errorsByLog() {
  if (DATA.by_log.length < 2) return null;
  const rows = DATA.by_log.map((l) => [l.name, ...l.share.map((s) => right("td", s === null ? "–" : percent(s))), right("td", percent(l.mean))]);
  return h("section", {}, h("h2", {}, "Error in each log"),
    h("p", { class: "lead" }, "RMS of model torque less measured torque, as a share of the measured torque's RMS in that log."),
    h("div", { class: "card" }, table(["log", ...DATA.joints.map((j) => right("th", j.short)), right("th", "mean")], rows)));
}

// ---------------------------------------------------------------- effects

const MANY = 12; // parameters of one effect; of more, those whose interval holds zero are folded away
const ROOM = 4; // parameters of one effect below which both parts of each interval are written out
const MARKS = { established: ["good", "established"], likely: ["warn", "likely"], descriptive: ["soft", "only descriptive"] };
const markOf = (confidence) => h("span", { class: "chip " + MARKS[confidence][0] }, MARKS[confidence][1]);

// Both parts of an interval; a shape parameter has none.
const partsOf = (p) => (p.parts && p.parts.length ? `± ${p.parts[0]} statistical, ± ${p.parts[1]} systematic` : null);

function parameters(e) {
  const spoken = e.parameters.length <= ROOM;
  const listed = (rows) => h("div", { class: "parameters" }, rows.map((p) => [
    h("span", { class: "soft" }, p.name),
    h("span", { class: p.telling === false ? "faint" : "", title: partsOf(p) }, p.text),
    h("span", {}, Charts.interval(p.interval, p.name + " " + p.text)),
    spoken && partsOf(p) ? h("span", { class: "parts soft" }, partsOf(p)) : null]));
  const all = [...e.parameters, ...e.shape], silent = all.length > MANY ? all.filter((p) => p.telling === false) : [];
  return [listed(all.filter((p) => !silent.includes(p))),
    silent.length ? h("details", { class: "plain" }, h("summary", {}, silent.length + " more whose interval holds 0"), listed(silent)) : null];
}

function effectTable(numbers) {
  const rows = numbers.map((n) => FOUND.effects.find((e) => e.number === n)).map((e) => [
    right("td", String(e.number), "soft"),
    h("td", {}, h("b", {}, e.name), h("div", { class: "soft" }, "on " + e.where),
      e.changed ? h("div", { class: "changed" }, "the model has it; the numbers are its change") : null,
      h("div", { class: "equation" }, "f = " + e.equation)),
    h("td", {}, parameters(e),
      e.profile ? h("div", { class: "soft" }, "present: " + e.profile) : null),
    h("td", {}, h("span", { class: "narrow-only" }, "helps most on "), e.error.joint, h("div", {}, h("span", { class: "b" }, percent(e.error.before)), " → ", h("span", { class: "a" }, percent(e.error.after)))),
    h("td", {}, e.confusions.length ? others(e.confusions) : h("span", { class: "soft" }, "nothing else tried comes near")),
  ]);
  return table([right("th", ""), wide("22%", "effect"), wide("34%", "parameters ± 95 %"),
    wide("13%", "error where it helps most"), "could be mistaken for"], rows);
}

function group(g, open) {
  return h("details", { class: "group", open: open ? "" : null },
    h("summary", {}, h("span", { class: "line" }, markOf(g.confidence), h("span", {}, g.words), g.numbers ? h("span", { class: "soft numbers" }, g.numbers) : null)),
    h("div", {}, effectTable(g.members)));
}

function effects() {
  if (!FOUND || !FOUND.effects.length) return null;
  const named = FOUND.groups.filter((g) => g.confidence !== "descriptive"), tail = FOUND.groups.filter((g) => g.confidence === "descriptive");
  const members = tail.flatMap((g) => g.members);
  const folded = tail.length ? h("details", { class: "group tail" },
    h("summary", {}, h("span", { class: "line" }, markOf("descriptive"), h("span", {}, tail.map((g) => g.words).join(", ")),
      h("span", { class: "soft numbers" }, "may be something else"))),
    h("div", {}, effectTable(members))) : null;
  addEventListener("beforeprint", () => document.querySelectorAll("details.group:not(.tail)").forEach((d) => { d.open = true; }));
  return h("section", { class: "effects" }, h("h2", {}, "What the model lacks"),
    h("p", { class: "lead" }, "Established: found again in both halves of the log, at other cut-offs and with links that are slightly wrong. Likely: found again in most of them. "
      + "Open a line for its equations and numbers: each effect adds a torque f on the right of M q̈ + nle = τ + f. A 95 % interval has a statistical and a systematic part; the interval of a faint parameter holds zero."),
    named.map((g) => group(g, named.length === 1)), folded);
}

function capability() {
  if (!FOUND) return null;
  const able = FOUND.capability;
  const rows = DATA.joints.map((j, k) => [j.name, right("td", able.friction[k]), right("td", percent(able.error[k]))]);
  return h("section", {}, h("h2", {}, "What the model is good for"),
    h("p", { class: "lead" }, "On motions such as this one it notices " + able.noticed + "."),
    h("div", { class: "card narrow" }, table(["joint", right("th", "friction that grows by"), right("th", "error as feedforward")], rows)));
}

const wide = (width, text) => h("th", { style: "width:" + width }, text);

const RIVALS = 2; // other explanations that are shown before the rest is folded away

function others(confusions) {
  const more = confusions.slice(RIVALS);
  return [h("span", { class: "narrow-only" }, "could be mistaken for "), byMotion(confusions.slice(0, RIVALS)),
    more.length ? h("details", { class: "plain" }, h("summary", {}, more.length + " more"), byMotion(more)) : null];
}

function byMotion(confusions) {
  const groups = new Map();
  for (const c of confusions) groups.set(c.motion, [...(groups.get(c.motion) || []), c.words]);
  return [...groups].map(([motion, words]) => h("div", { class: "other" }, words.join(", "),
    h("div", { class: "soft" }, motion)));
}

// ---------------------------------------------------------------- errors by joint

function errors() {
  const largest = Math.max(...DATA.joints.map((j) => Math.max(share(j, j.before.rms), j.after ? share(j, j.after.rms) : 0)));
  const at = (s) => "left:" + (100 * s) / largest + "%";
  const bar = (s, style) => h("i", { class: style, style: "width:" + (100 * s) / largest + "%" });
  const both = (j, rms, style, torque = j.torque_rms) => [right("td", withUnit(rms, j.units.load), style), right("td", percent(over(rms, torque)), style)];
  const rows = DATA.joints.map((j) => [
    h("td", {}, j.name, j.rests ? h("div", { class: "soft" }, "rests: in no mean") : j.structure_left ? h("div", { class: "soft" }, "structure is left") : null),
    right("td", withUnit(j.torque_rms, j.units.load)),
    ...both(j, j.before.rms, "b"),
    ...(j.after ? both(j, j.after.rms, "a") : []),
    ...(FOUND ? [...both(j, j.heldout, "", j.heldout_torque_rms), ...both(j, j.floor, "soft")] : []),
    h("td", { class: "wide-only" }, h("div", { class: "bar", role: "img", "aria-label": j.name + ": " + percent(share(j, j.before.rms)) },
      bar(share(j, j.before.rms), "one"), j.after ? bar(share(j, j.after.rms), "two") : null,
      FOUND ? h("i", { class: "mark", style: at(share(j, j.floor)) }) : null)),
  ]);
  const pair = (label) => h("th", { colspan: 2, class: "n" }, label);
  const heads = ["joint", right("th", "torque RMS"), pair("as given"), ...(IMPROVED ? [pair("improved")] : []),
    ...(FOUND ? [pair("held out"), pair("noise floor")] : []), h("th", { class: "wide-only", style: "width:22%" }, "share of the torque RMS")];
  return h("section", {}, h("h2", {}, "Error by joint"),
    h("p", { class: "lead" }, "RMS of model torque less measured torque, and its share of the measured torque's RMS."
      + (FOUND ? " Held out: the improved model on data it was not fitted to. Noise floor: what nothing smooth in the motion explains (the tick at the bars)." : "")),
    h("div", { class: "card" }, table(heads, rows)));
}

// ---------------------------------------------------------------- the error falling

function falling() {
  if (!FOUND || FOUND.trace.length < 2) return null;
  const trace = FOUND.trace;
  const big = h("div", { class: "chart" });
  const boxes = DATA.joints.map(() => h("div", { class: "chart" }));
  const heads = ["added", ...DATA.joints.map((j) => right("th", j.short)), right("th", "mean"), right("th", "held out")];
  const rows = trace.map((s, k) => [(k ? k + ". " : "") + s.added, ...s.share.map((v) => right("td", percent(v))), right("td", percent(s.mean)), right("td", percent(s.heldout_mean))]);
  rows.push([h("td", { class: "soft" }, "noise floor"), ...FOUND.floor.map((v) => right("td", percent(v), "soft")), right("td", percent(FOUND.floor_mean), "soft"), ""]);
  return {
    node: h("section", {}, h("h2", {}, "The error falling, step by step"),
      h("p", { class: "lead" }, "RMS error as a share of the torque RMS. After each added effect all effects so far are fitted together. Held out: " + (DATA.holdout.length
        ? "the held-out log." : "each block of time predicted from the others.")),
      legend(["after", "means", "fitted"], ["heldout", "dashed", "held out"], ["floor", "dotted", "noise floor"]),
      h("div", { class: "card" }, h("h3", {}, "Mean over the joints"), big),
      h("div", { class: "grid", style: "margin-top:14px" }, DATA.joints.map((j, k) => h("div", { class: "card" }, h("h3", {}, j.name), boxes[k]))),
      h("details", { style: "margin-top:14px" }, h("summary", {}, "The numbers"), h("div", {}, table(heads, rows)))),
    draw() {
      JointCharts.fall(big, { fitted: trace.map((s) => s.mean), heldout: trace.map((s) => s.heldout_mean), floor: FOUND.floor_mean }, { height: 250 });
      boxes.forEach((box, j) => JointCharts.fall(box, { fitted: trace.map((s) => s.share[j]), heldout: trace.map((s) => s.heldout[j]), floor: FOUND.floor[j] },
        { height: 150, small: true }));
    },
  };
}

// ---------------------------------------------------------------- one joint

function overTime(j) {
  const [torque, residual] = [h("div", { class: "chart" }), h("div", { class: "chart" })];
  return {
    node: h("div", { class: "card stack" },
      h("h3", {}, j.name + ": residual, model less measured"), residual,
      h("h3", {}, j.name + ": measured and model torque"), torque,
      legend(j.time.rest.length && ["band", "band", "near rest, where friction is whatever holds the joint: not counted"],
        j.time.logs.length && ["soft", "thin", "vertical line: the next log begins, or the next part of one after a gap"]),
      h("div", { class: "soft small" }, hint(ZOOM))),
    draw() {
      JointCharts.logResidual(residual, j, { clock });
      JointCharts.logTorque(torque, j, { clock });
    },
  };
}

function againstMotion(j) {
  const names = Object.keys(j.against);
  const boxes = names.map(() => h("div", { class: "chart" }));
  const accounted = (m) => [h("span", { class: "b" }, percent(m.before.share)), m.after ? [" → ", h("span", { class: "a" }, percent(m.after.share))] : null];
  const curve = names.some((s) => j.against[s].curve);
  const helping = FOUND ? FOUND.effects.filter((e) => !e.joints.length || e.joints.includes(j.name)).map((e) => e.name) : [];
  return {
    node: h("div", { class: "stack" },
      legend(["before", "dots", "residual as given"], ["before", "means", "its mean by region"],
        IMPROVED && ["after", "dots", "residual improved"], IMPROVED && ["after", "means", "its mean by region"],
        curve && ["curve", "dashed", "what the added effects explain" + (helping.length ? ": " + helping.join(", ") : "")]),
      h("div", { class: "two-up" }, names.map((s, k) => h("div", { class: "card" },
        h("h3", {}, j.name + ": residual against " + s), h("div", { class: "legend" }, h("span", {}, "means by region account for ", accounted(j.against[s].means), " of the residual's variance")), boxes[k])))),
    draw() { names.forEach((s, k) => JointCharts.against(boxes[k], j, s)); },
  };
}

const buttons = () => jointButtons((j) => [h("span", { class: "b" }, percent(share(j, j.before.rms))),
  j.after ? [" → ", h("span", { class: "a" }, percent(share(j, j.after.rms)))] : null]);

function joints() {
  return h("section", {}, h("h2", {}, "Residual against motion and load"),
    h("p", { class: "lead" }, "Choose a joint. The residual is the torque f that the model lacks: where its mean bends with the velocity, think of friction; with the position, of gravity or springs; with the acceleration, of inertia; with the load, of gains."),
    buttons(), ofJoint((j) => [againstMotion(j)]));
}

// ---------------------------------------------------------------- regions and records

const regionWords = (r) => "on " + r.joint + ": |residual| " + num(r.ratio, 2) + "× its mean where " + r.where;

function regions() {
  const of = (name, style, list) => list && list.length ? h("div", { class: "card dense" },
    h("h3", { class: style }, name),
    table(["joint", "where", right("th", "× its mean"), right("th", "bias there")], list.map((r) => [
      r.joint, r.where, right("td", num(r.ratio, 2)),
      right("td", withUnit(r.bias, DATA.joints.find((j) => j.name === r.joint).units.load, 2))]))) : null;
  return h("section", {}, h("h2", {}, "Worst regions"),
    h("p", { class: "lead" }, "Where a joint's |residual| (RMS) is largest beside that of its whole log. A ratio near 1 everywhere means that the error is spread evenly, as noise is."),
    h("div", { class: IMPROVED ? "two-up" : "" }, of("Model as given", "b", DATA.regions.before), of("Improved model", "a", DATA.regions.after)));
}

const RECORDED = {
  cutoff: "cut-off of the compared torques [Hz]", motion_cutoff: "cut-off of the motion [Hz]",
  trim: "cut from both ends [periods of the cut-off]", source: "log", log_rate: "rate of the log [Hz]",
  motion_rate: "rate of positions, velocities, accelerations [Hz]", compared_rate: "rate of compared torques [Hz]",
  blocks: "blocks of time, each predicted from the others", effects: "effects tried",
};

function records() {
  const list = (record) => table(null, Object.entries(record).map(([k, v]) => [
    h("td", { class: "soft", style: "width:30%" }, RECORDED[k] || k.replaceAll("_", " ")),
    h("td", {}, Array.isArray(v) ? (v.length ? v.map((x) => h("div", {}, String(x))) : "none")
      : v !== null && typeof v === "object" ? JSON.stringify(v) : typeof v === "number" ? String(+v.toPrecision(5)) : v === "" ? "–" : String(v))]));
  const record = (l, what) => h("details", {}, h("summary", {}, what + " " + l.source), h("div", {}, list(l)));
  const checks = DATA.checks.map((c) => h("details", { open: c.problems ? "" : null },
    h("summary", {}, "Check of " + c.source + ": " + (c.problems ? plural(c.problems, "finding") + " to look at" : "nothing to worry about")),
    h("div", {}, table(["", "about", "joint", "finding"], c.findings.map((f) => [
      h("td", { class: "mark-" + f.severity }, f.severity), f.topic.replaceAll("_", " "), f.joint || "",
      h("td", {}, f.message, f.advice ? h("div", { class: "soft" }, "→ " + f.advice) : null)])))));
  return h("section", {}, h("h2", {}, "What was done to the log"),
    h("p", { class: "lead" }, "Positions and torques pass one zero-phase filter; velocity and acceleration are derived from the positions; what the model predicts is filtered again together with what was measured."),
    checks, DATA.logs.map((l) => record(l, "Conditioning of")), DATA.holdout.map((l) => record(l, "Conditioning of the held-out log")),
    FOUND ? h("details", {}, h("summary", {}, "Settings of the discovery"), h("div", {}, list(FOUND.settings))) : null,
    h("details", {}, h("summary", {}, "Words used on this page"), h("div", {}, h("p", {}, "Residual: torque that the model predicts for the measured motion, less the measured torque. Positive: the joint moved as if helped by a torque that the model lacks."),
      h("p", {}, "Relative error: RMS residual over RMS measured torque of that joint. Samples near rest are not counted for joints that move, since static friction there takes any value."),
      h("p", {}, "Noise floor: what is left when smooth functions of position, velocity, load and time are fitted to the residual as well. No model is likely to get far below it."))));
}

// ---------------------------------------------------------------- page

const LEAD = "Replays the log. A link takes the colour of its joint's error beside its torque"
  + (FOUND && FOUND.trace.length > 1 ? "; add effect after effect and see it clear" : "")
  + ".";

show([head(), verdict(), changes(), motion(LEAD, buttons(), (j) => [overTime(j)]), effects(), capability(), errorsByLog(), errors(), falling(), joints(), regions(), records(),
  h("footer", {}, "Made by cdia-pin " + DATA.version + ". One file, no network; charts by uPlot (MIT).")]);
chosen.choose(mostTelling());
