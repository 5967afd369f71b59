"use strict";
// Charts of a joint's signals over time and over its motion. A chart is drawn into an element from data and options;
// it follows the width of its element and the colours of the page, and shares a clock with whatever else shows time.

const Charts = (() => {
  const { h, svg, withUnit, seconds } = Cdia;

  // ---------------------------------------------------------------- colours and life

  const color = (name) => (name.startsWith("#") ? name : getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim());
  const alpha = (css, a) => css + Math.round(a * 255).toString(16).padStart(2, "0"); // colours are #rrggbb
  const font = (px = 12) => px + "px " + getComputedStyle(document.body).fontFamily;

  const alive = new Set(); // charts that follow the width of their box and the colours of the page
  const widths = new ResizeObserver(fit);

  function fit() {
    for (const c of alive) if (c.box.clientWidth && c.box.clientWidth !== c.plot.width) c.plot.setSize({ width: c.box.clientWidth, height: c.plot.height });
  }

  function recolour() {
    for (const c of alive) c.make();
  }

  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", recolour);
  matchMedia("print").addEventListener("change", fit);

  function chart(box, height, options, data, clock) {
    const c = { box, plot: null, clock };
    c.make = () => {
      if (c.plot) c.plot.destroy();
      c.plot = new uPlot({ width: Math.max(box.clientWidth, 200), height, ...options() }, data, box);
      if (clock) follow(c);
    };
    c.make();
    if (clock) c.leave = clock.listen(() => place(c));
    alive.add(c);
    widths.observe(box);
    return c;
  }

  // Forget the charts inside an element, before it is emptied.
  function clear(element) {
    for (const c of alive) {
      if (!element.contains(c.box)) continue;
      if (c.leave) c.leave();
      widths.unobserve(c.box);
      c.plot.destroy();
      alive.delete(c);
    }
  }

  // ---------------------------------------------------------------- one time for all

  // A moment [s] that charts, strips and the picture of the arm share. Whoever sets it is not notified.
  class Clock {
    constructor() { this.time = null; this.listeners = new Set(); }
    listen(listener) { this.listeners.add(listener); return () => this.listeners.delete(listener); }
    set(time, teller = null) {
      if (time === this.time) return;
      this.time = time;
      for (const listener of this.listeners) if (listener !== teller) listener(time);
    }
  }

  function place(c) { // the cursor of a chart at the time of its clock, unless the pointer is on the chart
    if (c.clock.time === null || !alive.has(c) || c.plot.over.matches(":hover")) return;
    const left = c.plot.valToPos(c.clock.time, "x");
    const inside = left >= 0 && left <= c.plot.over.clientWidth;
    c.plot.setCursor({ left: inside ? left : -10, top: inside ? 0 : -10 }, false, false);
  }

  function follow(c) {
    const over = c.plot.over;
    over.addEventListener("pointermove", (e) => c.clock.set(c.plot.posToVal(e.clientX - over.getBoundingClientRect().left, "x")));
    over.addEventListener("pointerleave", () => setTimeout(() => place(c)));
    setTimeout(() => place(c)); // once it has been drawn
  }

  // ---------------------------------------------------------------- axes and lines

  const axis = (label, more = {}) => ({
    label, labelSize: label ? 20 : 0, labelFont: font(), font: font(), stroke: color("soft"), labelGap: 2, size: 30,
    grid: { stroke: color("grid"), width: 1 }, ticks: { stroke: color("line"), width: 1, size: 4 }, gap: 4, ...more,
  });
  const plain = (u, values) => values.map((v) => (v === null ? "" : String(+v.toPrecision(6)).replace("-", "−")));

  function range(values, margin = 0.04) {
    let [low, high] = [Infinity, -Infinity];
    for (const v of values) if (v !== null) [low, high] = [Math.min(low, v), Math.max(high, v)];
    if (!(high >= low)) return [-1, 1];
    const room = (high - low || Math.abs(high) || 1) * margin;
    return [low - room, high + room];
  }

  function clipped(u, paint) {
    const c = u.ctx, { left, top, width, height } = u.bbox;
    c.save();
    c.beginPath(); c.rect(left, top, width, height); c.clip();
    paint(c, { left, top, width, height });
    c.restore();
  }

  const shade = (spans) => (u) => clipped(u, (c, { top, height }) => {
    for (const { from, to, colour, opacity = 1 } of spans) {
      const [a, b] = [u.valToPos(from, "x", true), u.valToPos(to, "x", true)];
      c.fillStyle = alpha(color(colour), opacity);
      c.fillRect(a, top, Math.max(b - a, 1), height);
    }
  });

  // Dashed upright lines with a text each; texts that would overlap stand below each other.
  const mark = (marks) => (u) => clipped(u, (c, { top, height }) => {
    const px = devicePixelRatio;
    c.strokeStyle = c.fillStyle = color("ink"); c.lineWidth = px; c.setLineDash([4 * px, 4 * px]);
    c.font = font(11 * px); c.textBaseline = "top"; c.textAlign = "left";
    let free = -Infinity, level = 0;
    for (const { time, text } of marks) {
      const x = u.valToPos(time, "x", true);
      level = x < free ? level + 1 : 0;
      c.beginPath(); c.moveTo(x, top); c.lineTo(x, top + height); c.stroke();
      c.fillText(text, x + 3 * px, top + (2 + 12 * level) * px);
      free = x + 18 * px;
    }
  });

  // Lines over time.
  //   lines    [{label, values, colour, width, dash, hidden}]; one with `under` fills the room down to the next line
  //   options  {time, label, unit, height, symmetric, spans, marks, clock, zoom}: charts of one `zoom` zoom together
  function overTime(box, lines, options) {
    const { time, label, unit, height = 220, symmetric, spans = [], marks = [], clock, zoom } = options;
    const most = 1.06 * lines.flatMap((l) => l.values).reduce((m, v) => Math.max(m, Math.abs(v ?? 0)), 1e-12);
    box.setAttribute("role", "group");
    box.setAttribute("aria-label", lines.filter((l) => !l.hidden).map((l) => l.label).join(", ") + " over time");
    const line = (l) => ({ label: l.label, class: l.hidden ? "hidden" : undefined, stroke: color(l.colour), width: l.width ?? 1.5, dash: l.dash,
      spanGaps: false, value: (u, v) => withUnit(v, unit), points: { show: false } });
    const bands = lines.flatMap((l, k) => (l.under ? [{ series: [k + 1, k + 2], fill: () => alpha(color(l.colour), 0.2) }] : []));
    return chart(box, height, () => ({
      padding: [8, 12, 0, 0], bands,
      scales: { x: { time: false, range: (u, low, high) => [low, high] }, y: symmetric ? { range: [-most, most] } : {} },
      legend: { markers: { width: 0, fill: (u, k) => u.series[k].stroke(u, k) } },
      hooks: { drawClear: [shade(spans)], draw: [mark(marks)] },
      cursor: { y: false, points: { size: 7 }, ...(zoom ? { sync: { key: zoom, setSeries: false } } : {}) },
      axes: [axis("time [s]", { values: plain }), axis(label, { size: 62, values: plain })],
      series: [{ label: "time", value: (u, v) => seconds(v) }, ...lines.map(line)],
    }), [time, ...lines.map((l) => l.values)], clock);
  }

  // ---------------------------------------------------------------- clouds and their curves

  function dots(name, opacity) {
    return (u, s) => {
      const [x, y] = u.data[s], size = 2.4 * devicePixelRatio;
      clipped(u, (c) => {
        c.fillStyle = alpha(color(name), opacity);
        for (let k = 0; k < x.length; k++) c.fillRect(u.valToPos(x[k], "x", true) - size / 2, u.valToPos(y[k], "y", true) - size / 2, size, size);
      });
      return null;
    };
  }

  const over = (means, curve) => (u) => clipped(u, (c) => {
    const px = devicePixelRatio, X = (v) => u.valToPos(v, "x", true), Y = (v) => u.valToPos(v, "y", true);
    const path = (xs, ys) => { c.beginPath(); xs.forEach((x, k) => (k ? c.lineTo(X(x), Y(ys[k])) : c.moveTo(X(x), Y(ys[k])))); c.stroke(); };
    c.lineJoin = "round"; c.strokeStyle = color("soft"); c.lineWidth = px;
    path([u.scales.x.min, u.scales.x.max], [0, 0]);
    for (const m of means) for (const [paint, more] of [["card", 3], [m.colour, 0]]) { // a halo keeps the line apart from its cloud
      c.strokeStyle = c.fillStyle = color(paint); c.lineWidth = (2 + more) * px;
      path(m.x, m.mean);
      m.x.forEach((x, k) => { c.beginPath(); c.arc(X(x), Y(m.mean[k]), (3.4 + more / 2) * px, 0, 7); c.fill(); });
    }
    if (curve) { c.strokeStyle = color("curve"); c.lineWidth = 2.2 * px; c.setLineDash([7 * px, 4 * px]); path(...curve); }
  });

  // Samples as dots, means by region as lines with a dot each, one dashed curve.
  //   clouds   [{x, y, colour, opacity}], means [{x, mean, colour}], curve [xs, ys] or null
  //   options  {x, y: what the axes are, with units, height}
  function scatter(box, clouds, means, curve, options) {
    const xs = range(clouds.flatMap((c) => c.x)), ys = range(clouds.flatMap((c) => c.y));
    return chart(box, options.height || 250, () => ({
      mode: 2, legend: { show: false }, cursor: { show: false }, padding: [8, 12, 0, 0],
      scales: { x: { time: false, range: xs }, y: { range: ys } },
      axes: [axis(options.x, { values: plain }), axis(options.y, { size: 58, values: plain })],
      series: [null, ...clouds.map((c) => ({ stroke: color(c.colour), paths: dots(c.colour, c.opacity) }))],
      hooks: { draw: [over(means, curve)] },
    }), [null, ...clouds.map((c) => [c.x, c.y])]);
  }

  // ---------------------------------------------------------------- legends

  function swatch(name, kind) {
    const paint = name.startsWith("#") ? name : "var(--" + name + ")", dash = { dashed: "5 3", dotted: "2 3" }[kind];
    const picture = svg("svg", { width: 22, height: 12, "aria-hidden": "true" });
    if (kind === "dots") for (const x of [4, 11, 18]) picture.append(svg("circle", { cx: x, cy: 6 + (x % 3) - 1, r: 2, fill: paint, opacity: 0.6 }));
    else if (kind.startsWith("band")) picture.append(svg("rect", { width: 22, height: 12, fill: paint, opacity: kind === "band" ? 1 : 0.35 }));
    else picture.append(svg("line", { x1: 0, x2: 22, y1: 6, y2: 6, stroke: paint, "stroke-width": kind === "thin" ? 1.5 : 2.5, ...(dash ? { "stroke-dasharray": dash } : {}) }));
    if (kind === "means") picture.append(svg("circle", { cx: 11, cy: 6, r: 3.5, fill: paint }));
    return picture;
  }

  // Items [colour, kind, words]; kinds: line, thin, dashed, dotted, dots, means, band, band faint.
  function legend(...items) {
    return h("div", { class: "legend" }, items.filter(Boolean).map(([name, kind, words]) => h("span", {}, swatch(name, kind), words)));
  }

  // An estimate with its interval [low, value, high] beside zero, as one line of a table.
  function interval(ends, words) {
    if (!ends) return null;
    const [low, value, high] = ends, from = Math.min(low, 0), to = Math.max(high, 0);
    const at = (x) => (6 + (84 * (x - from)) / (to - from || 1)).toFixed(1);
    return svg("svg", { width: 96, height: 12, role: "img", "aria-label": words },
      svg("line", { x1: at(0), x2: at(0), y1: 0, y2: 12, stroke: "var(--floor)" }),
      svg("line", { x1: at(low), x2: at(high), y1: 6, y2: 6, stroke: "var(--after)", "stroke-width": 2 }),
      svg("circle", { cx: at(value), cy: 6, r: 3.2, fill: "var(--after)" }));
  }

  // ---------------------------------------------------------------- strips

  // One row a name, its spans beside each other; a click or a drag sets the clock.
  //   rows     [{name, title, spans: [{from, to, colour, words, style}]}]
  //   options  {begin, end, clock}
  function strips(rows, { begin, end, clock }) {
    const at = (t) => (100 * (t - begin)) / (end - begin || 1);
    const heads = [];
    const move = (e) => {
      const { left, width } = e.currentTarget.getBoundingClientRect();
      clock.set(begin + ((end - begin) * Math.min(Math.max(e.clientX - left, 0), width)) / width, null);
    };
    const row = ({ name, title, spans }) => {
      const head = h("span", { class: "playhead", hidden: "" });
      heads.push(head);
      return [h("span", { title }, name), h("div", { class: "strip", role: "img", onpointermove: clock ? move : () => {},
        "aria-label": (title || name) + ": " + (spans.map((s) => s.words).join(", ") || "nothing") },
      spans.map((s) => h("i", { class: s.style, title: s.words, style: `left:${at(s.from)}%;width:${at(s.to) - at(s.from)}%;` + (s.colour ? `background:${s.colour}` : "") })), head)];
    };
    const ticks = [0, 0.25, 0.5, 0.75, 1].map((s) => h("span", {}, +(begin + s * (end - begin)).toFixed(2) + " s"));
    const node = h("div", { class: "strips" }, rows.map(row), h("span", {}), h("div", { class: "ticks" }, ticks));
    const show = (t) => heads.forEach((x) => { x.hidden = t === null; x.style.left = at(t) + "%"; });
    if (clock) { show(clock.time); clock.listen(show); }
    return node;
  }

  return { Clock, chart, clear, overTime, scatter, strips, legend, interval, axis, plain, color, alpha };
})();
