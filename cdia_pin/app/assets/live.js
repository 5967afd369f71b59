// An arm that moves now: a tile for each joint with its stage, and the residual of the joint that is chosen.

const SHOWN = 20; // [s] of the past

export default {
  template: '<div><div class="tiles" role="group" aria-label="Joints"></div><div class="charts"></div></div>',
  mounted() {
    this.ready = CdiaScripts("base.js", "uPlot.js", "charts.js");
  },
  unmounted() {
    if (globalThis.Charts) Charts.clear(this.$el);
  },
  methods: {
    // joints: [{name, short, unit, blind}], stages: [{name, colour, words}]
    async begin(joints, stages) {
      await this.ready;
      const { h } = Cdia, [tiles, chart] = this.$el.children;
      Object.assign(this, { joints, stages, past: [], chosen: 0 });
      this.tiles = joints.map((joint, k) => {
        const stage = h("span", { class: "numbers" }, "–"), level = h("i", { class: "one" });
        const node = h("button", { type: "button", class: "tile live", "data-mark": "live-tile-" + joint.name, onclick: () => this.choose(k, true) },
          h("span", { class: "name" }, joint.short), stage,
          joint.blind ? h("span", { class: "name", title: "a fault of 30 % of its torque could not be seen" }, "blind") : null, h("span", { class: "bar", "aria-hidden": "true" }, level, h("em", {})));
        return { node, stage, level };
      });
      this.arm = h("span", { class: "name" }, "–");
      const arm = h("div", { class: "tile live whole", role: "status", "aria-label": "Whole arm", "data-mark": "live-tile-arm" },
        h("span", { class: "name" }, "whole arm"), this.arm);
      tiles.replaceChildren(...this.tiles.map((t) => t.node), arm);
      this.title = h("h3", {});
      this.box = h("div", { class: "chart" });
      Charts.clear(chart);
      chart.replaceChildren(this.title, Charts.legend(["after", "line", "residual"], ["floor", "dashed", "± threshold"]), this.box);
      this.choose(0, false);
    },
    choose(k, told) {
      this.chosen = k;
      this.tiles.forEach((t, i) => t.node.setAttribute("aria-pressed", String(i === k)));
      this.title.textContent = "What the model of " + this.joints[k].name + " misses now";
      this.chart();
      if (told) this.$emit("joint", this.joints[k].name);
    },
    async select(name) {
      await this.ready;
      const k = (this.joints || []).findIndex((joint) => joint.name === name);
      if (k >= 0) this.choose(k, false);
    },
    // piece: {time, stage, residual, threshold, attached}, rows of frames
    async push(piece) {
      await this.ready;
      if (!this.joints || !piece.time) return;
      piece.time.forEach((time, k) => this.past.push({ time, residual: piece.residual[k], threshold: piece.threshold[k] }));
      const now = piece.time[piece.time.length - 1];
      while (this.past.length && this.past[0].time < now - SHOWN) this.past.shift();
      const last = piece.time.length - 1, attached = (piece.attached || []).slice(-1)[0];
      if (attached) this.arm.textContent = attached[1].words.join("; ") || "–";
      this.tiles.forEach((tile, k) => {
        const stage = this.stages[piece.stage[last][k]], level = Math.abs(piece.residual[last][k]) / piece.threshold[last][k];
        if (tile.node.dataset.stage !== stage.name) {
          tile.node.dataset.stage = stage.name;
          const blind = this.joints[k].blind ? ", blind" : "";
          tile.stage.textContent = stage.name;
          tile.node.style.setProperty("--stage", stage.colour);
          tile.node.setAttribute("aria-label", this.joints[k].name + ": " + stage.name + blind + (stage.words ? ", " + stage.words : ""));
        }
        tile.level.style.width = 100 * Math.min(level / 2, 1) + "%"; // the mark in the middle is the threshold
      });
      this.plot.plot.setData(this.data());
    },
    data() {
      const of = (key, sign = 1) => this.past.map((p) => sign * p[key][this.chosen]);
      return [this.past.map((p) => p.time), of("residual"), of("threshold"), of("threshold", -1)];
    },
    chart() {
      const { axis, plain, color } = Charts, unit = this.joints[this.chosen].unit;
      Charts.clear(this.box);
      this.box.replaceChildren();
      const line = (colour, more) => ({ stroke: color(colour), width: 1.5, points: { show: false }, ...more });
      const most = (u, low, high) => { const m = 1.1 * Math.max(Math.abs(low || 0), Math.abs(high || 0), 1e-3); return [-m, m]; };
      this.plot = Charts.chart(this.box, 210, () => ({
        padding: [8, 12, 0, 0], legend: { show: false }, cursor: { show: false },
        scales: { x: { time: false, range: (u, low, high) => [Math.max(high - SHOWN, 0) || 0, high || SHOWN] }, y: { range: most } },
        axes: [axis("time [s]", { values: plain }), axis("residual [" + unit + "]", { size: 62, values: plain })],
        series: [{}, line("after"), line("floor", { dash: [6, 3] }), line("floor", { dash: [6, 3] })],
      }), this.data());
    },
  },
};
