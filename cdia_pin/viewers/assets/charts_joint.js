"use strict";
// The charts of one joint and of a discovery: what the data of a report say, drawn by `Charts`.

const JointCharts = (() => {
  const { seconds } = Cdia;
  const { overTime, strips, chart, axis, plain, color } = Charts;

  const line = (label, values, colour, more = {}) => ({ label, values, colour, ...more });
  const sum = (x, y) => x.map((v, k) => (v === null || y[k] === null ? null : v + y[k]));

  // ---------------------------------------------------------------- a monitor's run
  // joint: as in cdia-monitor-report/1; options: {stages: {name: {colour, words}}, marks: [{time, text}], clock}

  function about(joint, options) {
    const spans = joint.stages.filter(([, , stage]) => stage !== "healthy")
      .map(([from, to, stage]) => ({ from, to, colour: options.stages[stage].colour, opacity: 0.2 }));
    return { time: joint.time, spans, marks: options.marks, clock: options.clock, zoom: "joint-" + joint.name };
  }

  function residual(box, joint, options) {
    const bound = (label, sign, hidden) => line(label, joint.threshold.map((x) => sign * x), "floor", { dash: [6, 3], hidden });
    const lines = [line("residual", joint.residual, "after"), bound("± threshold", 1), bound("lower", -1, true)];
    return overTime(box, lines, { ...about(joint, options), height: 260, symmetric: true, unit: joint.units.residual, label: "residual [" + joint.units.residual + "]" });
  }

  // The model's torque is what is measured and what it lacks; of residuals that are no torque there is none.
  function torque(box, joint, options) {
    const unit = joint.units.load, lines = [line("measured", joint.effort, "measured", { width: 3 })];
    if (joint.units.residual === unit) lines.push(line("modelled", sum(joint.effort, joint.residual), "after"));
    if (joint.correction.some((x) => x)) lines.push(line("correction", joint.correction, "before"));
    return overTime(box, lines, { ...about(joint, options), unit, label: "torque [" + unit + "]" });
  }

  function tracking(box, joint, options) {
    const unit = "m" + joint.units.position;
    const error = joint.error.map((x) => (x === null ? null : 1e3 * x));
    return overTime(box, [line("tracking error", error, "curve")], { ...about(joint, options), height: 200, unit, label: "q − q_d [" + unit + "]" });
  }

  // A parameter as it was estimated, with its 95 % interval: {name, unit, time, value, low, high, real}.
  function parameter(box, joint, p, options) {
    const lines = [line("upper end", p.high, "after", { width: 0, hidden: true, under: true }), line("lower end", p.low, "after", { width: 0, hidden: true }),
      line("estimated", p.value, "after", { width: 2 })];
    if (p.real !== null) lines.push(line("in the plant", p.time.map(() => p.real), "floor", { dash: [6, 3] }));
    return overTime(box, lines, { time: p.time, unit: p.unit, label: p.name + " [" + p.unit + "]", height: 170, clock: options.clock });
  }

  const MOTION = { position: "position q", velocity: "velocity q̇", load: "torque τ" };

  // The residual while the joint is at fault, and while it is not, against one signal of its motion.
  function faulty(box, joint, signal) {
    const a = joint.against, s = a.signals[signal];
    const clouds = [{ x: s.healthy, y: a.healthy, colour: "measured", opacity: 0.5 }, { x: s.x, y: a.residual, colour: "before", opacity: 0.4 }];
    return Charts.scatter(box, clouds, [], s.curve, {
      x: MOTION[signal] + " of " + joint.name + " [" + joint.units[signal] + "]", y: "residual [" + joint.units.residual + "]" });
  }

  function stages(joints, options) {
    const words = (from, to, what) => what + ", " + seconds(from) + " to " + seconds(to);
    const rows = joints.map((j) => ({ name: j.short, title: j.name, spans: [
      ...j.stages.map(([from, to, stage]) => ({ from, to, colour: options.stages[stage].colour, style: stage === "healthy" ? "calm" : "", words: words(from, to, stage) })),
      ...j.present.map(([from, to, what]) => ({ from, to, style: "true", words: words(from, to, "in the plant: " + what) })),
    ] }));
    return strips(rows, options);
  }

  const HOW = { open: "possible", possible: "possible", leading: "" };

  function hypotheses(joint, options) {
    const rows = joint.hypotheses.map(({ effect, spans }) => ({ name: effect, spans: spans.map(([from, to, how]) => ({
      from, to, colour: "var(--" + (how === "open" ? "floor" : "after") + ")", style: HOW[how], words: how + ", " + seconds(from) + " to " + seconds(to) })) }));
    const times = joint.hypotheses.flatMap((row) => row.spans.flatMap(([from, to]) => [from, to]));
    const room = 0.08 * (Math.max(...times) - Math.min(...times));
    return strips(rows, { ...options, begin: Math.max(Math.min(...times) - room, options.begin), end: Math.min(Math.max(...times) + room, options.end) });
  }

  // ---------------------------------------------------------------- a comparison or a discovery
  // joint: as in cdia-report/1; options: {clock}

  function ofLog(joint, options) {
    const t = joint.time, end = t.time[t.time.length - 1];
    const spans = t.rest.map(([from, to]) => ({ from, to, colour: "band" })).concat(t.logs.map((x) => ({ from: x, to: x, colour: "soft" })));
    return { time: t.time, spans: spans.filter((s) => s.from <= end), clock: options.clock, zoom: "joint-" + joint.name, unit: joint.units.load };
  }

  function logTorque(box, joint, options) {
    const t = joint.time, lines = [line("measured", t.measured, "measured", { width: 4 }), line("as given", sum(t.measured, t.before), "before")];
    if (t.after) lines.push(line("improved", sum(t.measured, t.after), "after"));
    return overTime(box, lines, { ...ofLog(joint, options), height: 280, label: "torque [" + joint.units.load + "]" });
  }

  function logResidual(box, joint, options) {
    const t = joint.time, lines = [line("as given", t.before, "before")];
    if (t.after) lines.push(line("improved", t.after, "after"));
    return overTime(box, lines, { ...ofLog(joint, options), label: "residual [" + joint.units.load + "]" });
  }

  const SYMBOLS = { velocity: "q̇", position: "q", acceleration: "q̈", load: "τ of the model" };

  function against(box, joint, signal) {
    const a = joint.against[signal], c = joint.cloud;
    const clouds = [{ x: c[signal], y: c.before, colour: "before", opacity: 0.35 }], means = [{ ...a.means.before, colour: "before" }];
    if (c.after) clouds.push({ x: signal === "load" ? c.load_after : c[signal], y: c.after, colour: "after", opacity: 0.4 });
    if (a.means.after) means.push({ ...a.means.after, colour: "after" });
    return Charts.scatter(box, clouds, means, a.curve, {
      x: signal + " " + SYMBOLS[signal] + " of " + joint.name + " [" + joint.units[signal] + "]", y: "residual [" + joint.units.load + "]" });
  }

  // The error after each effect, shares of the torque RMS [1].
  function fall(box, { fitted, heldout, floor }, { height, small }) {
    const steps = fitted.map((_, k) => k), top = 108 * Math.max(...fitted, ...heldout, floor), many = small ? 12 : 40;
    const dotted = (name, more) => ({ stroke: color(name), width: 2, points: { show: true, size: 6, fill: color(name) }, ...more });
    return chart(box, height, () => ({
      legend: { show: false }, cursor: { show: false }, padding: [10, 14, 0, 0],
      scales: { x: { time: false, range: [-0.15, Math.max(steps.length - 1, 1) + 0.15] }, y: { range: [0, top || 1] } },
      axes: [
        axis(small ? null : "effects added (numbers as in the table above; 0 = as given)", {
          splits: () => steps, values: (u, s) => s.map((v) => (steps.length > many && v % 2 ? "" : String(v))), grid: { show: false } }),
        axis(small ? null : "% of torque RMS", { size: small ? 50 : 44, values: (u, s) => plain(u, s).map((v) => (small ? v + " %" : v)) })],
      series: [{},
        dotted("heldout", { dash: [6, 4], points: { show: true, size: 5, fill: color("card"), stroke: color("heldout") } }),
        dotted("after"),
        dotted("floor", { width: 1.5, dash: [2, 3], points: { show: false } })],
    }), [steps, heldout.map((v) => 100 * v), fitted.map((v) => 100 * v), steps.map(() => 100 * floor)]);
  }

  return { residual, torque, tracking, parameter, faulty, stages, hypotheses, logTorque, logResidual, against, fall };
})();
