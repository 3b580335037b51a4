// What a page is about is asked first.
import { EditPage } from "./edit.js";
import { GrainsPage } from "./grains.js";
import { unpack } from "./packed.js";
import { say } from "./panel.js";
import { askBytes } from "./server.js";
import { Stage } from "./stage.js";

async function open() {
  const buffer = await askBytes("/open");
  const stage = new Stage(document.getElementById("view"));
  const panel = document.getElementById("panel");
  if (unpack(buffer).head.kind === "edit") {
    window.page = new EditPage(stage, panel, buffer);
    document.body.dataset.ready = "true";
    return;
  }
  const series = { step: (step) => askBytes("/step", { step }), array: (step, array) => askBytes("/array", { step, array }) };
  window.page = new GrainsPage(stage, panel, buffer, series);
  document.body.dataset.ready = "true";
}

open().catch((error) => say(error.message, true));
