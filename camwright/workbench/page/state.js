// What the page knows: the job's text with its history, what was drawn last, what was pinned. Whoever wants to know is told.

import { withValue } from "./toml.js";

const told = new Set();

export const state = {
  text: "",
  history: [],
  at: -1,
  drawn: null, // the newest preview
  ghost: null, // the one before the present edit
  pinned: null,
  proof: null, // the newest design
  refusal: null,
  status: "",
  keys: [],
  targets: [],
};

export const onChange = (listener) => told.add(listener);
export const changed = (what) => told.forEach((listener) => listener(what));

export function begin(text) {
  Object.assign(state, { text, history: [text], at: 0 });
}

/** Change the text while a hand is still at it. */
export function draft(text) {
  state.text = text;
  changed("draft");
}

/** Keep the text as one step of the history. */
export function commit(text = state.text) {
  state.text = text;
  if (text !== state.history[state.at]) {
    state.history = [...state.history.slice(0, state.at + 1), text];
    state.at = state.history.length - 1;
    state.ghost = state.drawn;
  }
  changed("commit");
}

export const set = (path, value) => commit(withValue(state.text, path, value));

export function step(by) {
  const to = state.at + by;
  if (to < 0 || to >= state.history.length) return;
  state.at = to;
  state.text = state.history[to];
  changed("commit");
}
