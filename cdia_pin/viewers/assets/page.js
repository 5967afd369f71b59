"use strict";
// What every page shares: nodes, numbers, tables and charts. Texts enter as text nodes only, never as markup.

const DATA = JSON.parse(document.getElementById("data").textContent);
const REPORT = document.getElementById("report");
let charts = []; // [{plot, box, height}] that follow the width of the window

// ---------------------------------------------------------------- words and numbers

function h(tag, attributes, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes || {})) {
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) node.setAttribute(key, value);
  }
  node.append(...children.flat(9).filter((c) => c !== null && c !== undefined && c !== false));
  return node;
}

function num(x, digits = 3) {
  if (x === null || x === undefined) return "–";
  if (x === 0) return "0";
  const power = Math.floor(Math.log10(Math.abs(x)));
  const text = power < -4 || power > 6 ? x.toExponential(digits - 1) : x.toFixed(Math.max(digits - 1 - power, 0));
  return text.replaceAll("-", "−");
}

function percent(share) {
  if (share === null || share === undefined) return "–";
  const value = 100 * share;
  if (value > 0 && value < 0.005) return "<0.01\u00a0%";
  return value.toFixed(value >= 9.95 ? 0 : value >= 0.995 ? 1 : 2) + "\u00a0%";
}

const withUnit = (x, unit, digits) => (x === null || x === undefined ? "–" : num(x, digits) + "\u00a0" + unit);
const plural = (n, word) => n + " " + word + (n === 1 ? "" : "s");
const mean = (values) => values.reduce((s, v) => s + v, 0) / values.length;
const tokens = () => getComputedStyle(document.documentElement);
const color = (name) => tokens().getPropertyValue("--" + name).trim();

function table(heads, rows) {
  const cells = (tag, row) => row.map((c) => (c instanceof Node && c.tagName === tag.toUpperCase() ? c : h(tag, {}, c)));
  return h("div", { class: "scroll" }, h("table", {},
    heads ? h("thead", {}, h("tr", {}, cells("th", heads))) : null,
    h("tbody", {}, rows.map((row) => h("tr", {}, cells("td", row))))));
}
const right = (tag, text, extra = "") => h(tag, { class: "n " + extra }, text);

// ---------------------------------------------------------------- charts

const font = () => "12px " + getComputedStyle(document.body).fontFamily;
const axis = (label, more = {}) => ({
  label, labelSize: label ? 20 : 0, labelFont: font(), font: font(), stroke: color("soft"), labelGap: 2, size: 30,
  grid: { stroke: color("grid"), width: 1 }, ticks: { stroke: color("line"), width: 1, size: 4 }, gap: 4, ...more,
});
const axisNumber = (u, values) => values.map((v) => (v === null ? "" : String(+v.toPrecision(6)).replace("-", "−")));

function chart(box, height, options, data) {
  const plot = new uPlot({ width: Math.max(box.clientWidth, 200), height, ...options }, data, box);
  charts.push({ plot, box, height });
  return plot;
}

function legend(...items) {
  return h("div", { class: "legend" }, items.filter(Boolean).map(([name, kind, label]) => h("span", {}, swatch(name, kind), label)));
}

function swatch(name, kind) {
  const ns = "http://www.w3.org/2000/svg";
  const make = (tag, attributes) => {
    const node = document.createElementNS(ns, tag);
    for (const [k, v] of Object.entries(attributes)) node.setAttribute(k, v);
    return node;
  };
  const svg = make("svg", { width: 22, height: 12, "aria-hidden": "true" });
  const paint = "var(--" + name + ")";
  const dash = { dashed: "5 3", dotted: "2 3" }[kind];
  if (kind === "dots") for (const x of [4, 11, 18]) svg.append(make("circle", { cx: x, cy: 6 + (x % 3) - 1, r: 2, fill: paint, opacity: 0.6 }));
  else if (kind.startsWith("band")) svg.append(make("rect", { width: 22, height: 12, fill: paint, opacity: kind === "band" ? 1 : 0.35 }));
  else svg.append(make("line", { x1: 0, x2: 22, y1: 6, y2: 6, stroke: paint, "stroke-width": kind === "thin" ? 1.5 : 2.5, ...(dash ? { "stroke-dasharray": dash } : {}) }));
  if (kind === "means") svg.append(make("circle", { cx: 11, cy: 6, r: 3.5, fill: paint }));
  return svg;
}

const alpha = (css, a) => css + Math.round(a * 255).toString(16).padStart(2, "0"); // colours are #rrggbb

function range(values, margin = 0.04) {
  let [low, high] = [Infinity, -Infinity];
  for (const v of values) if (v !== null) [low, high] = [Math.min(low, v), Math.max(high, v)];
  if (!(high >= low)) return [-1, 1];
  const room = (high - low || Math.abs(high) || 1) * margin;
  return [low - room, high + room];
}

// ---------------------------------------------------------------- page

function fit() {
  for (const { plot, box, height } of charts) if (box.clientWidth && box.clientWidth !== plot.width) plot.setSize({ width: box.clientWidth, height });
}

// Show a list of parts, nodes or {node, draw}; again whenever the colours change.
function show(parts) {
  const build = () => {
    for (const c of charts) c.plot.destroy();
    charts = [];
    const made = parts().filter(Boolean);
    REPORT.replaceChildren(...made.map((p) => (p instanceof Node ? p : p.node)));
    for (const p of made) if (p.draw) p.draw();
  };
  build();
  new ResizeObserver(fit).observe(REPORT);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", build);
  matchMedia("print").addEventListener("change", fit);
}

// One button a joint, and the parts of the joint that is chosen: make(k) returns [{node, draw}].
function picker(chosen, label, make) {
  const place = h("div", { class: "stack" });
  let mine = []; // charts of the joint that is shown
  const buttons = DATA.joints.map((j, k) => h("button", { type: "button", onclick: () => choose(k) }, j.name, h("small", {}, label(j))));
  function choose(k) {
    picker.chosen = k;
    buttons.forEach((b, i) => b.setAttribute("aria-pressed", String(i === k)));
    for (const c of mine) c.plot.destroy();
    charts = charts.filter((c) => !mine.includes(c));
    const others = charts.length;
    const parts = make(DATA.joints[k]);
    place.replaceChildren(...parts.map((p) => (p instanceof Node ? p : p.node)));
    parts.forEach((p) => p.draw && p.draw());
    mine = charts.slice(others);
  }
  return {
    node: [h("div", { class: "picker", role: "group", "aria-label": "joint" }, buttons), place],
    draw() { choose(picker.chosen ?? chosen); },
  };
}
