"use strict";
// The arm that moves: tied to the clock of the charts and to the joint that is chosen.

const SCENE = JSON.parse(document.getElementById("scene").textContent);
const FEW = 6; // steps that have a button each; more share a slider

// The models to be shown in turn, each a track of the player: the first and the last with their residuals over time,
// those between with the error of each joint over the whole motion.
function tracks(timeline, steps) {
  if (steps.length < 3) return timeline;
  const [last] = timeline.variants, rows = (values) => timeline.time.map(() => values);
  const between = steps.slice(1, -1).map((s) => ({
    name: s.name, stage: rows(s.level.map(() => 0)), level: rows(s.level), torque: null, label: [[timeline.time[0], s.label]] }));
  return { ...timeline, variants: [...between, last] };
}

// Buttons or a slider that add effect after effect.
function steps(player, names) {
  if (names.length < 2) return null;
  const said = h("b", { "aria-live": "polite" });
  const show = (k) => {
    player.show(k);
    said.textContent = names[k];
    buttons.forEach((b, i) => b.setAttribute("aria-pressed", String(i === k)));
  };
  const buttons = names.length > FEW ? [] : names.map((name, k) => h("button", { type: "button", onclick: () => show(k) }, name));
  if (buttons.length) {
    show(0);
    return h("div", { class: "picker steps", role: "group", "aria-label": "model" }, h("span", { class: "soft" }, "Coloured by the error of the model"), buttons);
  }
  const slider = h("input", { type: "range", min: 0, max: names.length - 1, value: 0, "aria-label": "effects added", oninput: (e) => show(+e.target.value) });
  show(0);
  return h("div", { class: "steps" }, h("span", { class: "soft" }, "Effects added: "), slider, said);
}

// When the page opens: a run at its begin, an error when its colours are strong for the first time.
function opening({ stages, time, level }) {
  if (stages.length > 1) return time[0];
  const sums = level.map((row) => row.reduce((s, x) => s + Math.min(x, 1), 0));
  return time[sums.findIndex((s) => s >= 0.85 * Math.max(...sums))];
}

// A section with the arm, and beside it the charts of the joint that is chosen; `lead` says what its colours mean.
function motion(lead, buttons, beside) {
  const box = h("div", { class: "card arm" }), place = h("div");
  return {
    node: h("section", { id: "motion" }, h("h2", {}, "The arm in motion"), h("p", { class: "lead" }, lead, hint(" Hover a chart to move the arm, click a link to choose its joint.")), place, buttons,
      h("div", { class: "beside" }, box, ofJoint(beside))),
    draw() {
      const arm = new Arm3D(box, SCENE.arm, { stages: SCENE.timeline.stages });
      const timeline = tracks(SCENE.timeline, SCENE.steps), player = new Player(arm, timeline);
      const names = SCENE.steps.length ? SCENE.steps.map((s) => s.name) : [timeline, ...(timeline.variants || [])].map((t) => t.name);
      place.append(...[steps(player, names)].filter(Boolean));
      const seek = (t) => { player.pause(); player.seek(t); };
      player.onTime = (t) => clock.set(t, seek);
      clock.listen(seek);
      arm.onSelect = (joint) => joint && chosen.choose(joint);
      chosen.listen((joint) => arm.select(joint));
      Object.assign(motion, { arm, player });
      player.seek(opening(timeline));
    },
  };
}
