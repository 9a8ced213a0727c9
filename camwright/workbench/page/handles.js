// Dragging: a handle changes one quantity of the job, by pointer in proportion, by arrow keys one in a hundred.

import { commit, draft, state } from "./state.js";
import { quantity, values, withValue, written } from "./toml.js";

const KEYS = { ArrowRight: 1.01, ArrowUp: 1.01, ArrowLeft: 1 / 1.01, ArrowDown: 1 / 1.01, PageUp: 1.1, PageDown: 1 / 1.1 };
const LEAST = 0.02; // of the value that a drag began with

/** The text with a quantity made greater by a factor; as it is where the value is no quantity. */
function changed(path, base, factor) {
  const found = quantity(base);
  return found ? withValue(state.text, path, written(found.number * Math.max(factor, LEAST), found.unit)) : state.text;
}

/** Make an element of a drawing change the quantity at a path; `share` is the part of it that a pixel stands for. */
export function onGrip(element, { path, vertical, share }) {
  element.addEventListener("keydown", (event) => {
    const factor = KEYS[event.key];
    if (!factor) return;
    event.preventDefault();
    commit(changed(path, values(state.text)[path], factor));
    document.querySelector(`#plots [data-path="${path}"]`)?.focus();
  });
  element.addEventListener("pointerdown", (event) => {
    event.preventDefault();
    element.focus();
    const base = values(state.text)[path];
    const drawing = element.ownerSVGElement;
    const zoom = drawing.viewBox.baseVal.width / drawing.getBoundingClientRect().width;
    const from = vertical ? -event.clientY : event.clientX;
    const move = (now) => draft(changed(path, base, 1 + ((vertical ? -now.clientY : now.clientX) - from) * zoom * share));
    const end = () => {
      for (const [name, listener] of [["pointermove", move], ["pointerup", end], ["pointercancel", end]]) removeEventListener(name, listener);
      commit(state.text, "release");
    };
    for (const [name, listener] of [["pointermove", move], ["pointerup", end], ["pointercancel", end]]) addEventListener(name, listener);
  });
}
