"use strict";
// Scripts that a part of the page needs are fetched once, when the part is first shown: the first paint waits for none.

globalThis.CdiaScripts = (() => {
  const fetched = new Map();
  const one = (name) => new Promise((done, failed) => {
    const node = Object.assign(document.createElement("script"), { src: "/cdia/" + name, onload: done, onerror: failed });
    document.head.append(node);
  });
  return async (...names) => { // one after the other: each may need those before it
    for (const name of names) {
      if (!fetched.has(name)) fetched.set(name, one(name));
      await fetched.get(name);
    }
  };
})();
