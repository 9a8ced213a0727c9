// A view that asks the server something: it waits, shows what came, or the refusal. What came late is left out.

import { post } from "../api.js";
import { make, waiting } from "../elements.js";
import { state } from "../state.js";
import { word } from "../words.js";

/** Ask for a call and show its answer in a place of the view. */
export async function ask(place, name, body, show) {
  const mine = (place.asked ?? 0) + 1;
  place.asked = mine;
  const text = state.text;
  place.replaceChildren(waiting());
  const { ok, data } = await post(name, body);
  if (mine !== place.asked || data.status === "stale" || !place.isConnected) return;
  place.dataset.text = text;
  place.replaceChildren(...(ok ? [show(data)].flat() : [make("p", data.message ?? "", "failed")]));
}

/** Whether a view shows what belongs to an earlier job. */
export const outdated = (panel) => [...panel.querySelectorAll("[data-text]")].some((place) => place.dataset.text !== state.text);

/** What is shown while there is no design: that it is on its way, or that there is none. */
export const noDesign = () => (state.status === "proving" || state.status === "preview" ? make("p", word("proving"), "waiting") : make("p", word(state.status), "failed"));
