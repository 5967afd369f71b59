"use strict";
// Nodes, numbers and words that pages and charts share. Texts enter as text nodes only, never as markup.

const Cdia = (() => {
  function h(tag, attributes, ...children) {
    const node = document.createElement(tag);
    for (const [key, value] of Object.entries(attributes || {})) {
      if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
      else if (value !== null && value !== undefined && value !== false) node.setAttribute(key, value);
    }
    node.append(...children.flat(9).filter((c) => c !== null && c !== undefined && c !== false));
    return node;
  }

  function svg(tag, attributes, ...children) {
    const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    node.append(...children);
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

  const withUnit = (x, unit, digits) => (x === null || x === undefined ? "–" : num(x, digits) + (unit === "1" ? "" : "\u00a0" + unit));
  const seconds = (t) => (t === null || t === undefined ? "–" : t.toFixed(2) + "\u00a0s");
  const plural = (n, word) => n + " " + word + (n === 1 ? "" : "s");
  const mean = (values) => values.reduce((s, v) => s + v, 0) / values.length;

  const isCell = (c, tag) => c instanceof Node && c.nodeName === tag.toUpperCase();
  const cells = (tag, row) => row.map((c) => (isCell(c, tag) ? c : h(tag, {}, c)));
  const right = (tag, text, extra = "") => h(tag, { class: "n " + extra }, text);

  function table(heads, rows) {
    return h("div", { class: "scroll" }, h("table", {},
      heads ? h("thead", {}, h("tr", {}, cells("th", heads))) : null,
      h("tbody", {}, rows.map((row) => h("tr", {}, cells("td", row))))));
  }

  return { h, svg, num, percent, withUnit, seconds, plural, mean, right, table };
})();
