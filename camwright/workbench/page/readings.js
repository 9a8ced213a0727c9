// The cursor through all plots, and the table beneath: values there, extremes with their places, limits, differences.

import { make } from "./elements.js";
import { digits, withUnit } from "./numbers.js";
import { greatest } from "./rows.js";
import { state } from "./state.js";
import { bindingName, word } from "./words.js";

let at = null; // number of the sample under the cursor

/** Build the table for what is drawn. */
export function show(box, place, shown) {
  const others = [["previous", state.ghost !== shown ? state.ghost : null], ["pinned", state.pinned]].filter(([, each]) => each && each.slave_unit === shown.slave_unit);
  const headings = [`${word(place.along.name)} (${place.along.unit})`, word("cursor"), word("greatest"), word("least"), word("limit"), ...others.map(([name]) => `Δ ${word(name)}`)];
  const head = make("tr");
  headings.forEach((heading, column) => head.append(Object.assign(make("th", heading, column ? "number" : ""), { scope: "col" })));
  const body = place.list.map((row) => line(row, place, shown, others.map(([, each]) => each)));
  const made = make("table");
  made.append(make("caption", caption(shown)), head, ...body);
  box.replaceChildren(made);
  read(box, place, shown);
}

function caption(shown) {
  const names = shown.binding.map(bindingName).join(", ");
  return names ? `${word("binds")}: ${names}` : word("nothing binds");
}

function line(row, place, shown, others) {
  const values = row.of(shown.samples);
  const made = make("tr");
  made.dataset.row = row.name;
  if (shown.binding.includes(row.limit)) made.className = "binding";
  made.append(Object.assign(make("th", row.unit === "1" ? word(row.name) : `${word(row.name)} (${row.unit})`), { scope: "row" }), make("td", "–", "number cursor"));
  for (const further of [(a, b) => a > b, (a, b) => a < b]) {
    const i = values.reduce((best, value, each) => (further(value, values[best]) ? each : best), 0);
    made.append(make("td", `${digits(values[i])} @ ${digits(place.x[i], 4)}`, "number"));
  }
  made.append(make("td", row.limit ? digits(shown.limits[row.limit] * row.factor) : "–", "number"));
  for (const other of others) made.append(make("td", difference(values, row.of(other.samples)), "number"));
  return made;
}

/** What the greatest value has changed by against another cam, and by how much of that one's. */
function difference(values, before) {
  if (!before) return "–";
  const [now, then] = [Math.abs(greatest(values)), Math.abs(greatest(before))];
  const sign = now < then ? "" : "+";
  return then === 0 ? `${sign}${digits(now - then)}` : `${sign}${digits(now - then, 4)} (${sign}${digits((100 * (now - then)) / then, 3)} %)`;
}

/** Put the cursor on the sample nearest to a place on the screen. */
export function point(box, place, shown, clientX) {
  const sizes = place.drawing.getBoundingClientRect();
  const here = ((clientX - sizes.left) / sizes.width) * place.width;
  if (here < place.left - 4 || here > place.right + 4) return;
  at = place.x.reduce((best, value, i) => (Math.abs(place.across(value) - here) < Math.abs(place.across(place.x[best]) - here) ? i : best), 0);
  read(box, place, shown);
}

/** Move the cursor by some samples; true where a key does that. */
export function key(box, place, shown, event) {
  const last = place.x.length - 1;
  const step = event.shiftKey ? 36 : 4;
  const to = { ArrowLeft: (at ?? 0) - step, ArrowRight: (at ?? -step) + step, Home: 0, End: last }[event.key];
  if (to === undefined) return false;
  at = Math.min(Math.max(to, 0), last);
  read(box, place, shown);
  box.querySelector("#spoken").textContent = [...box.querySelectorAll("tr[data-row]")].map((row) => `${row.cells[0].textContent} ${row.cells[1].textContent}`).join(", ");
  return true;
}

function read(box, place, shown) {
  const cursor = place.drawing.querySelector("#cursor");
  const shownAt = at !== null && at < place.x.length ? at : null;
  const here = shownAt === null ? -9 : place.across(place.x[shownAt]);
  cursor.setAttribute("x1", here);
  cursor.setAttribute("x2", here);
  box.querySelector("thead, tr").cells[1].textContent = shownAt === null ? word("cursor") : `@ ${withUnit(place.x[shownAt], place.along.unit)}`;
  for (const row of place.list) {
    const cell = box.querySelector(`tr[data-row="${row.name}"] .cursor`);
    cell.textContent = shownAt === null ? "–" : digits(row.of(shown.samples)[shownAt]);
  }
  if (!box.querySelector("#spoken")) box.append(Object.assign(make("p", "", "spoken"), { id: "spoken", ariaLive: "polite" }));
}
