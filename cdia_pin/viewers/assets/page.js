"use strict";
// What every page shares: its data, its parts, and the joint that is chosen.

const { h, num, percent, withUnit, seconds, plural, mean, right, table } = Cdia;
const { legend } = Charts;
const DATA = JSON.parse(document.getElementById("data").textContent);
const REPORT = document.getElementById("report");
const clock = new Charts.Clock(); // the moment that charts and the picture of the arm show

// What a mouse can do; paper does not say it.
const hint = (words) => h("span", { class: "screen-only" }, words);
const ZOOM = "Drag across a chart to zoom, double-click to go back.";

// Show a list of parts, nodes or {node, draw}: drawn once they stand in the page and have a width.
function show(parts) {
  const made = parts.flat().filter(Boolean);
  REPORT.replaceChildren(...made.map((p) => (p instanceof Node ? p : p.node)));
  for (const p of made) if (p.draw) p.draw();
}

// One joint is chosen at a time, by its button or by its link; whoever shows it listens.
const chosen = {
  joint: null,
  listeners: [],
  listen(listener) { this.listeners.push(listener); },
  choose(name) {
    if (name === this.joint || !DATA.joints.some((j) => j.name === name)) return;
    this.joint = name;
    for (const listener of this.listeners) listener(name);
  },
};

// One button a joint.
function jointButtons(label) {
  const buttons = DATA.joints.map((j) => h("button", { type: "button", onclick: () => chosen.choose(j.name) }, j.name, h("small", {}, label(j))));
  chosen.listen((name) => buttons.forEach((b, k) => b.setAttribute("aria-pressed", String(DATA.joints[k].name === name))));
  return h("div", { class: "picker", role: "group", "aria-label": "joint" }, buttons);
}

// A place that shows the joint that is chosen: make(joint) returns parts.
function ofJoint(make) {
  const place = h("div", { class: "stack" });
  chosen.listen((name) => {
    Charts.clear(place);
    const parts = make(DATA.joints.find((j) => j.name === name)).filter(Boolean);
    place.replaceChildren(...parts.map((p) => (p instanceof Node ? p : p.node)));
    for (const p of parts) if (p.draw) p.draw();
  });
  return place;
}
