// The arm as a part of the page: `Arm3D` with a `Player` for a log, or posed frame by frame while it moves.

export default {
  template: "<div></div>",
  async mounted() {
    this.ready = CdiaScripts("base.js", "uPlot.js", "charts.js", "meshcat.js", "arm3d.js");
  },
  unmounted() {
    this.clear();
  },
  methods: {
    // Draw an arm anew; nothing moves yet.
    async draw(scene, stages, reach) {
      await this.ready;
      this.clear();
      this.arm = new Arm3D(this.$el, scene, { stages: stages || [] });
      this.arm.onSelect = (joint) => this.$emit("joint", joint);
      this.$el.arm = this.arm;
      this.reach = reach;
    },
    // Show a motion over time; the time that was shown, and whether it played, are kept.
    async play(timeline, variant) {
      await this.ready;
      if (!this.arm) return;
      const { time = null, playing = false } = this.player || {};
      if (this.player) this.leave();
      this.player = this.$el.player = new Player(this.arm, timeline);
      const seek = (t) => { this.player.pause(); this.player.seek(t); };
      const leave = Cdia.clock().listen(seek);
      this.leave = () => { leave(); this.player.dispose(); };
      this.player.onTime = (t) => Cdia.clock().set(t, seek);
      if (variant) this.player.show(variant);
      if (time !== null) this.player.seek(time);
      if (playing) this.player.play();
    },
    // Show an arm that moves now: pieces of its timeline, as they come.
    async append(piece, stages) {
      await this.ready;
      if (!this.arm) return;
      if (!this.player) {
        this.player = this.$el.player = new Player(this.arm, { live: true, stages });
        this.leave = () => this.player.dispose();
        this.player.append(piece);
        if (this.reach) this.arm.frame(this.reach);
      } else this.player.append(piece);
    },
    async select(joint) {
      await this.ready;
      if (this.arm) this.arm.select(joint);
    },
    clear() {
      if (this.player) this.leave();
      if (this.arm) this.arm.dispose();
      this.arm = this.player = null;
      this.$el.replaceChildren();
    },
  },
};
