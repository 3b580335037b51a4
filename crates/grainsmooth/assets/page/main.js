// What a page is about is asked first.
import { GrainsPage } from "./grains.js";
import { say } from "./panel.js";
import { askBytes } from "./server.js";
import { Stage } from "./stage.js";

async function open() {
  const buffer = await askBytes("/open");
  const stage = new Stage(document.getElementById("view"));
  const panel = document.getElementById("panel");
  const series = { step: (step) => askBytes("/step", { step }), array: (step, array) => askBytes("/array", { step, array }) };
  window.page = new GrainsPage(stage, panel, buffer, series);
  document.body.dataset.ready = "true";
}

open().catch((error) => say(error.message, true));
