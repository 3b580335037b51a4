// The controls beside the view. Each has a label; what has a key says it.
const keys = new Map();

function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

// A titled part of the panel.
export function group(parent, title) {
  const made = element("fieldset", { className: "group" }, element("legend", { textContent: title }));
  parent.append(made);
  return made;
}

export function row(parent, ...children) {
  const made = element("div", { className: "row" }, ...children);
  parent.append(made);
  return made;
}

// A slider that tells its value; `say` spells it.
export function slider(parent, label, { id, min = 0, max = 1, step = 0.01, value = 0, say = String }, change) {
  const shown = element("output", { textContent: say(value) });
  const input = element("input", { type: "range", id, min, max, step, value });
  input.value = value;
  input.addEventListener("input", () => {
    shown.textContent = say(Number(input.value));
    change(Number(input.value));
  });
  row(parent, element("span", { textContent: label }), input, shown);
  input.setAttribute("aria-label", label);
  return {
    input,
    get value() { return Number(input.value); },
    set value(value) {
      input.value = value;
      shown.textContent = say(Number(input.value));
    },
  };
}

// A list to choose from: pairs of a value and what is said.
export function choice(parent, label, { id, options, value }, change) {
  const input = element("select", { id });
  input.setAttribute("aria-label", label);
  const fill = (options) => input.replaceChildren(...options.map(([value, text]) => element("option", { value, textContent: text })));
  fill(options);
  if (value !== undefined) input.value = value;
  input.addEventListener("input", () => change(input.value));
  row(parent, element("span", { textContent: label }), input);
  return { input, fill };
}

export function check(parent, label, { id, value = false, key }, change) {
  const input = element("input", { type: "checkbox", id, checked: value });
  input.addEventListener("input", () => change(input.checked));
  parent.append(element("label", { className: "row" }, input, element("span", { textContent: label }), ...hint(key)));
  if (key) keys.set(key, () => input.click());
  return input;
}

export function button(parent, label, { id, key, title = "" }, press) {
  const made = element("button", { type: "button", id, title }, label + " ", ...hint(key));
  made.addEventListener("click", press);
  parent.append(made);
  if (key) keys.set(key, press);
  return made;
}

function hint(key) {
  return key ? [element("kbd", { textContent: key })] : [];
}

// Names and values, one below the other.
export function facts(list, pairs) {
  list.className = "facts";
  list.replaceChildren(...pairs.flatMap(([name, value]) => [element("dt", { textContent: name }), element("dd", { textContent: value })]));
}

export function say(text, isBad = false) {
  const status = document.getElementById("status");
  if (!status) return;
  status.textContent = text;
  status.classList.toggle("bad", isBad);
}

// A number with four digits that count.
export function digits(number) {
  if (number === null || number === undefined || Number.isNaN(number)) return "none";
  if (Number.isInteger(number)) return String(number);
  return String(Number(number.toPrecision(4)));
}

export { element };

// Keys do what their buttons do, but not while a text is typed.
document.addEventListener("keydown", (event) => {
  if (event.target.matches("select, input:not([type=range], [type=checkbox])") || event.altKey) return;
  const name = event.key.length === 1 ? event.key.toUpperCase() : event.key;
  const modifiers = (event.ctrlKey || event.metaKey ? "Ctrl+" : "") + (event.shiftKey && name !== "?" ? "Shift+" : "");
  const press = keys.get(modifiers + name);
  if (!press) return;
  event.preventDefault();
  press();
});
