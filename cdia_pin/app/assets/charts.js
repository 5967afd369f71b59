// The charts of the joint that is chosen, drawn as the reports draw them.

const SIGNALS = ["velocity", "position", "acceleration", "load"];

export default {
  template: "<div></div>",
  async mounted() {
    this.ready = CdiaScripts("base.js", "uPlot.js", "charts.js", "charts_joint.js");
    this.signal = SIGNALS[0];
  },
  unmounted() {
    if (globalThis.Charts) Charts.clear(this.$el);
  },
  methods: {
    async draw(joint) {
      await this.ready;
      Charts.clear(this.$el);
      const { h } = Cdia, { legend } = Charts, both = Boolean(joint.after);
      const torque = h("div", { class: "chart" }), residual = h("div", { class: "chart" });
      const buttons = SIGNALS.map((s) => h("button", { type: "button", onclick: () => against(s) }, s));
      const against = (signal) => {
        this.signal = signal;
        buttons.forEach((b, k) => b.setAttribute("aria-pressed", String(SIGNALS[k] === signal)));
        Charts.clear(residual);
        residual.replaceChildren();
        JointCharts.against(residual, joint, signal);
      };
      this.$el.replaceChildren(
        h("h3", {}, "Torque of " + joint.name),
        torque,
        h("h3", {}, "What the model misses, against "),
        h("div", { class: "picker", role: "group", "aria-label": "signal" }, buttons),
        legend(["before", "dots", "as given"], both && ["after", "dots", "improved"], both && ["curve", "dashed", "what was added"]),
        residual);
      JointCharts.logTorque(torque, joint, { clock: Cdia.clock() });
      against(this.signal);
      this.$el.dataset.joint = joint.name;
    },
  },
};
