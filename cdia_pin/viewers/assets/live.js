"use strict";
// The page of `cdia view`: an arm, its player, and the frames that the command sends.

const box = (id) => document.getElementById(id);

function show(id, sentence) {
  box(id).textContent = sentence;
  box(id).hidden = !sentence;
}

async function begin() {
  const setup = await (await fetch("/setup.json")).json();
  document.title = setup.title + " · cdia view";
  globalThis.arm = new Arm3D(box("arm"), setup.scene, { stages: setup.timeline.stages, zoom: "always" });
  globalThis.player = new Player(arm, setup.timeline);
  if (!setup.timeline.live) player.play();
  const socket = new WebSocket(`ws://${location.host}/stream`);
  socket.onmessage = (event) => {
    const message = JSON.parse(event.data);
    if (message.time) player.append(message);
    if (message.say !== undefined) show("said", message.say);
    if (message.finished) player.finish();
  };
  socket.onclose = () => {
    player.finish();
    show("said", "");
    show("lost", "Connection lost: the command that showed this arm has ended. What it has sent can still be played.");
  };
}

begin().catch((error) => show("lost", "The arm cannot be shown: " + error.message));
