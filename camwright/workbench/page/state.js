// What the page knows: the job's text with its history, what was drawn last, what was pinned. Whoever wants to know is told.

import { withValue } from "./toml.js";

const MOST = 200; // steps that are kept to be undone

const told = new Set();

export const state = {
  text: "",
  history: [],
  at: -1,
  drawn: null, // what the plots show: the newest preview, or the design once it is there
  ghost: null, // the one before the present edit
  pinned: null,
  overlay: null, // a table or a recording that was dropped
  proof: null, // the newest design, null while there is none of this text
  refusal: null,
  status: "",
  laws: ["linear_return", "poly_3_4_5"], // baselines to draw
  keys: [],
  targets: [],
  known: { laws: [] },
};

export const onChange = (listener) => told.add(listener);
export const changed = (what) => told.forEach((listener) => listener(what));

export function begin(text) {
  Object.assign(state, { text, history: [text], at: 0 });
}

let moving = false; // whether a hand is at it: what stood before is kept once

function keepGhost() {
  if (!moving) state.ghost = state.drawn;
}

/** Change the text while a hand is still at it. */
export function draft(text) {
  keepGhost();
  moving = true;
  state.text = text;
  changed("draft");
}

/** Keep the text as one step of the history; a hand that let go ("release") has nothing to follow, a key may be pressed again. */
export function commit(text = state.text, how = "commit") {
  state.text = text;
  if (text !== state.history[state.at]) {
    keepGhost();
    state.history = [...state.history.slice(0, state.at + 1), text].slice(-MOST);
    state.at = state.history.length - 1;
  }
  moving = false;
  changed(how);
}

export const set = (path, value) => commit(withValue(state.text, path, value), "release");

export function step(by) {
  const to = state.at + by;
  if (to < 0 || to >= state.history.length) return;
  keepGhost();
  state.at = to;
  state.text = state.history[to];
  changed("commit");
}
