// A view that asks the server something: it waits, shows what came, or the refusal. What is no longer wanted is called off.

import { post } from "../api.js";
import { make, waiting } from "../elements.js";
import { state } from "../state.js";
import { word } from "../words.js";

const open = new Map(); // calls that run, by the place that they are for

/** Ask for a call and show its answer in a place of the view. */
export async function ask(place, name, body, show) {
  open.get(place)?.abort();
  const control = new AbortController();
  open.set(place, control);
  const text = state.text;
  place.replaceChildren(waiting());
  const { ok, data } = await post(name, body, control.signal);
  if (open.get(place) === control) open.delete(place);
  if (control.signal.aborted || data.status === "stale" || !place.isConnected) return;
  place.dataset.text = text;
  place.replaceChildren(...(ok ? [show(data)].flat() : [make("p", data.message ?? "", "failed")]));
}

/** Call off all that was asked for. */
export function callOff() {
  for (const control of open.values()) control.abort();
  open.clear();
}

/** Whether a view shows what belongs to an earlier job. */
export const outdated = (panel) => [panel, ...panel.querySelectorAll("[data-text]")].some((place) => place.dataset.text !== undefined && place.dataset.text !== state.text);

/** What is shown while there is no design: that it is on its way, or that there is none. */
export const noDesign = () => (state.status === "proving" || state.status === "preview" ? make("p", word("proving"), "waiting") : make("p", word(state.status), "failed"));
