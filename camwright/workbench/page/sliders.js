// Sliders for what is turned most: the middle is the value that a hand began at, either end a quarter and four times of it.

import { make } from "./elements.js";
import { printedQuantity } from "./numbers.js";
import { commit, draft, state } from "./state.js";
import { quantity, values, withValue, written } from "./toml.js";
import { word } from "./words.js";

const SLIDERS = { "cut.length": "cut length", "cut.line_speed": "line speed", "cut.sync_zone": "sync zone", "limits.speed": "speed", "limits.acceleration": "acceleration", "limits.jerk": "jerk" };

export function build(box) {
  box.replaceChildren(...Object.entries(SLIDERS).map(([path, name]) => {
    const row = make("div", undefined, "slider");
    row.dataset.path = path;
    const slider = Object.assign(make("input"), { type: "range", min: -100, max: 100, step: 1, id: `slider-${path}` });
    const label = Object.assign(make("label", path.startsWith("limits.") ? `${word("limit")}: ${word(name)}` : word(name)), { htmlFor: slider.id });
    slider.addEventListener("pointerdown", () => begin(row));
    slider.addEventListener("input", () => draft(moved(row, Number(slider.value))));
    slider.addEventListener("change", () => {
      commit(moved(row, Number(slider.value)));
      delete row.dataset.base;
      place(row, values(state.text)[path]);
    });
    row.append(label, slider, make("output"));
    return row;
  }));
}

function begin(row) {
  row.dataset.base = values(state.text)[row.dataset.path] ?? "";
}

function moved(row, way) {
  if (row.dataset.base === undefined) begin(row);
  const base = quantity(row.dataset.base);
  return base ? withValue(state.text, row.dataset.path, written(base.number * 4 ** (way / 100), base.unit)) : state.text;
}

function place(row, value) {
  const found = quantity(value);
  const told = found ? printedQuantity(found) : (value ?? "–");
  row.querySelector("output").textContent = told;
  const slider = row.querySelector("input");
  slider.disabled = !found;
  slider.setAttribute("aria-valuetext", told);
  if (row.dataset.base === undefined) slider.value = 0;
}

export function refresh(box) {
  const known = values(state.text);
  for (const row of box.children) place(row, known[row.dataset.path]);
}
