// The job as a form made from the list of keys: values stand as they are typed, faults at their field.

import { commit, draft, set, state } from "./state.js";
import { quantity, values, withValue } from "./toml.js";
import { digits } from "./plots.js";
import { word } from "./words.js";

const SLIDERS = { "cut.length": "cut length", "cut.line_speed": "line speed", "cut.sync_zone": "sync zone", "limits.acceleration": "acceleration", "limits.jerk": "jerk" };

/** Build the form for the machine that the job names. */
export function build(form) {
  const known = values(state.text);
  const kind = JSON.parse(known["machine.kind"] ?? '""');
  form.replaceChildren();
  const tables = Map.groupBy(state.keys.filter((key) => key.machine === "" || key.machine === kind), (key) => key.table);
  for (const [table, keys] of tables) {
    const set = document.createElement("fieldset");
    const legend = document.createElement("legend");
    legend.textContent = table || "job";
    set.append(legend, ...keys.map((key) => field(key, known[key.path])));
    form.append(set);
  }
}

function field(key, value) {
  const row = document.createElement("div");
  row.className = "field";
  row.dataset.path = key.path;
  const label = document.createElement("label");
  const input = document.createElement("input");
  input.id = `field-${key.path}`;
  label.htmlFor = input.id;
  label.textContent = key.name;
  label.title = `${key.meaning}. ${key.takes}`;
  input.value = value ?? "";
  input.placeholder = key.default || `${word("optional")}: ${key.example}`;
  input.addEventListener("change", () => set(key.path, input.value.trim()));
  row.append(label, input);
  return row;
}

/** Bring the values of the text into the form, and the sliders to their places. */
export function refresh(form, sliders) {
  const known = values(state.text);
  const kind = form.dataset.kind;
  if (kind !== known["machine.kind"]) {
    form.dataset.kind = known["machine.kind"];
    build(form);
  }
  for (const row of form.querySelectorAll(".field")) {
    const input = row.querySelector("input");
    if (input !== document.activeElement) input.value = known[row.dataset.path] ?? "";
  }
  for (const row of sliders.children) place(row, known[row.dataset.path]);
}

/** Show the faults at their fields; what is about no field is left to the refusal. */
export function showFaults(form, faults) {
  for (const row of form.querySelectorAll(".field")) {
    row.removeAttribute("aria-invalid");
    row.querySelector(".fault")?.remove();
    const found = faults.find((fault) => fault.field === row.dataset.path);
    if (!found) continue;
    const told = document.createElement("p");
    told.className = "fault";
    told.textContent = found.message;
    row.setAttribute("aria-invalid", "true");
    row.append(told);
  }
}

export function buildSliders(box) {
  box.replaceChildren(...Object.entries(SLIDERS).map(([path, name]) => {
    const row = document.createElement("div");
    row.className = "slider";
    row.dataset.path = path;
    const label = document.createElement("label");
    const slider = Object.assign(document.createElement("input"), { type: "range", min: -100, max: 100, step: 1, id: `slider-${path}` });
    label.htmlFor = slider.id;
    label.textContent = word(name);
    slider.addEventListener("pointerdown", () => start(row));
    slider.addEventListener("keydown", () => row.dataset.base || start(row));
    slider.addEventListener("input", () => draft(moved(row, Number(slider.value))));
    slider.addEventListener("change", () => {
      commit(moved(row, Number(slider.value)));
      delete row.dataset.base;
    });
    row.append(label, slider, document.createElement("output"));
    return row;
  }));
}

function start(row) {
  row.dataset.base = values(state.text)[row.dataset.path] ?? "";
}

/** A slider's way is a factor of 4 to both sides of the value that it began at. */
function moved(row, way) {
  if (row.dataset.base === undefined) start(row);
  const base = quantity(row.dataset.base);
  if (!base) return state.text;
  const value = base.number * 4 ** (way / 100);
  return withValue(state.text, row.dataset.path, JSON.stringify(`${Number(value.toPrecision(4))} ${base.unit}`));
}

function place(row, value) {
  const found = quantity(value);
  row.querySelector("output").textContent = found ? `${digits(found.number)} ${found.unit}` : (value ?? "–");
  const slider = row.querySelector("input");
  slider.disabled = !found;
  if (row.dataset.base === undefined) slider.value = 0;
}
