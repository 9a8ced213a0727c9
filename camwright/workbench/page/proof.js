// From the text to what is shown: a preview while a hand moves, the whole design when it rests.

import { newestOnly, post, textOf } from "./api.js";
import { changed, state } from "./state.js";

const REST = 150; // ms without a change by keys after which a design begins: a key that is held down is one change

const refusedAs = (data) => (data.status === "infeasible" ? "infeasible" : data.status === "gone" ? "gone" : "faulty");

const preview = newestOnly(async (text) => {
  const { ok, data } = await post("preview", { toml: text, laws: state.laws, place: state.drawn?.place ?? null });
  if (text !== state.text) return; // a newer one is on its way
  state.refusal = ok ? null : data;
  if (ok && state.proof === null) state.drawn = data;
  if (!ok) state.status = refusedAs(data);
  else if (state.proof === null && state.status !== "proving") state.status = "preview";
  changed("drawn");
});

let asked = 0;
let waiting = 0;
let running = new AbortController(); // of the design that runs

async function prove() {
  const mine = (asked += 1);
  state.status = "proving";
  changed("status");
  const { ok, data } = await post("design", { toml: state.text, brief: true }, running.signal);
  if (mine !== asked || data.status === "stale") return;
  state.refusal = ok ? null : data;
  state.status = ok ? (data.passed ? "proved" : "failed") : refusedAs(data);
  if (ok) {
    state.proof = { ...data, design: textOf(data.contents["out/design.json"]) };
    const cam = await post("cam", { design: state.proof.design, laws: state.laws });
    if (mine !== asked) return;
    if (cam.ok) state.drawn = { ...cam.data, objective: data.objective };
  }
  changed("drawn");
  changed("proof");
}

/** The text changed under a hand: show it, prove nothing. */
export function drafted() {
  asked += 1;
  running.abort();
  running = new AbortController();
  clearTimeout(waiting);
  state.proof = null;
  if (state.status !== "infeasible" && state.status !== "faulty") state.status = "preview";
  preview(state.text);
}

/** The text is one to keep: show it at once, and prove it, when no other follows if one may. */
export function committed(what) {
  drafted();
  if (what === "release") prove();
  else waiting = setTimeout(prove, REST);
}

/** Draw the same cam with other baselines. */
export async function redraw() {
  if (state.proof === null) return preview(state.text);
  const mine = asked;
  const { ok, data } = await post("cam", { design: state.proof.design, laws: state.laws });
  if (!ok || mine !== asked) return undefined;
  state.drawn = { ...data, objective: state.proof.objective };
  return changed("drawn");
}
