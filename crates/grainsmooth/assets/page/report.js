// The view of a report: what `grainsmooth view` shows, without a program to ask; and a table of all grains.
import { GrainsPage } from "./grains.js";
import { digits, element } from "./panel.js";
import { Stage } from "./stage.js";

const text = document.getElementById("network").textContent;
const buffer = Uint8Array.from(atob(text), (character) => character.charCodeAt(0)).buffer;
const list = document.getElementById("grains");
const rows = new Map();
const page = new GrainsPage(new Stage(document.getElementById("view")), document.getElementById("panel"), buffer, null, (id) => markRow(id));

// Thousands of rows are made when they are asked for.
list.addEventListener("toggle", () => {
  if (rows.size > 0) return;
  const { ids, columns } = page.head;
  const told = columns.filter(({ values }) => !values.colors);
  const head = element("tr", {}, element("th", { textContent: "grain" }), ...told.map(({ name }) => element("th", { textContent: name })));
  const table = element("table", {}, head);
  ids.forEach((id, grain) => {
    const cells = told.map(({ values }) => element("td", { textContent: digits((values.numbers ?? values.kinds)[grain]) }));
    const row = element("tr", {}, element("td", { textContent: id }), ...cells);
    row.addEventListener("click", () => page.choose(grain));
    rows.set(id, row);
    table.append(row);
  });
  list.querySelector(".table").append(table);
  markRow(page.head.ids[page.selected]);
});
list.hidden = page.head.columns.length === 0;

function markRow(id) {
  for (const row of rows.values()) row.classList.remove("selected");
  const row = rows.get(id);
  if (!row) return;
  row.classList.add("selected");
  // Within the table: the page stays where it is.
  const box = list.querySelector(".table");
  const [own, around] = [row, box].map((one) => one.getBoundingClientRect());
  box.scrollTop += own.top - around.top - around.height / 2;
}
