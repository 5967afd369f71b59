// Files and folders that are dropped anywhere on the page, or chosen, are sent to the app one after the other.

export default {
  template: `<div class="drop"><input id="drop-input" type="file" multiple aria-label="files"><p>Drop a log, a URDF with its meshes, or drive gains.</p></div>`,
  props: { address: String, suffixes: Array },
  mounted() {
    const input = this.$el.querySelector("input");
    input.onchange = () => {
      this.send([...input.files].map((file) => [file.webkitRelativePath || file.name, file]));
      input.value = "";
    };
    const shown = (over) => { this.$el.dataset.over = over ? "yes" : "no"; };
    const files = (event) => event.dataTransfer && [...event.dataTransfer.types].includes("Files");
    this.listeners = {
      dragover: (event) => { if (files(event)) { event.preventDefault(); shown(true); } },
      dragleave: (event) => { if (!event.relatedTarget) shown(false); },
      drop: (event) => {
        if (!files(event)) return;
        event.preventDefault();
        shown(false);
        const items = [...event.dataTransfer.items].filter((item) => item.kind === "file");
        const entries = items.map((item) => item.webkitGetAsEntry() || item.getAsFile());
        this.gather(entries).then((found) => this.send(found));
      },
    };
    for (const [name, listener] of Object.entries(this.listeners)) document.addEventListener(name, listener);
  },
  unmounted() {
    for (const [name, listener] of Object.entries(this.listeners)) document.removeEventListener(name, listener);
  },
  methods: {
    // All files of entries and of the folders among them, each with its path.
    async gather(entries, path = "") {
      const found = [];
      for (const entry of entries) {
        if (entry instanceof File) { // where folders are not known
          found.push([path + entry.name, entry]);
          continue;
        }
        if (entry.isFile) {
          found.push([path + entry.name, await new Promise((done, failed) => entry.file(done, failed))]);
          continue;
        }
        const reader = entry.createReader(), inside = [];
        for (;;) { // a reader hands out a folder in pieces
          const piece = await new Promise((done, failed) => reader.readEntries(done, failed));
          if (!piece.length) break;
          inside.push(...piece);
        }
        found.push(...(await this.gather(inside, path + entry.name + "/")));
      }
      return found;
    },
    async send(files) {
      const known = files.filter(([path]) => this.suffixes.some((suffix) => path.toLowerCase().endsWith(suffix)));
      if (!known.length) return this.$emit("refused", "nothing to use in " + files.slice(0, 5).map(([path]) => path).join(", "));
      const drop = crypto.randomUUID();
      for (const [path, file] of known) {
        const asked = new URLSearchParams({ drop, path });
        const answer = await fetch(this.address + "?" + asked, { method: "POST", body: file }).catch(() => null);
        if (!answer || !answer.ok) return this.$emit("refused", answer ? await answer.text() : path + " could not be sent");
      }
      this.$emit("dropped", drop);
    },
  },
};
