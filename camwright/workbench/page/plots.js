// Stacked plots over the master: zones shaded, limits as lines, extremes marked, handles for what a hand may drag.

import { svg } from "./elements.js";
import { digits, lengthUnit, withUnit } from "./numbers.js";
import { abscissa, extremes, rowsOf } from "./rows.js";
import { path, ticks } from "./scale.js";
import { state } from "./state.js";
import { word } from "./words.js";

const LEFT = 62, RIGHT = 14, ROW = 112, GAP = 30, TOP = 34;

/** Curves beside the cam: the one before, the pinned one, a dropped file, baselines. */
export function curvesBeside(shown) {
  const found = [];
  const like = (each) => each && each.slave_unit === shown.slave_unit;
  if (like(state.ghost) && state.ghost !== shown) found.push({ kind: "ghost", name: word("previous"), samples: state.ghost.samples });
  if (like(state.pinned)) found.push({ kind: "pinned", name: word("pinned"), samples: state.pinned.samples });
  for (const [law, samples] of Object.entries(shown.laws)) found.push({ kind: `law ${law}`, name: word(law), samples });
  if (state.overlay) {
    found.push({ kind: "overlay", name: state.overlay.name, samples: state.overlay.samples });
    if (state.overlay.actual) found.push({ kind: "overlay actual", name: `${state.overlay.name}: ${word("axis")}`, samples: state.overlay.actual });
  }
  return found;
}

function span(row, shown, beside) {
  let [low, high] = [0, 0];
  const seen = row.name === "jerk" ? beside.filter(({ kind }) => !kind.startsWith("law")) : beside;
  for (const { samples } of [{ samples: shown.samples }, ...seen]) {
    for (const value of row.of(samples) ?? []) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  const limit = row.limit ? shown.limits[row.limit] * row.factor : null;
  if (limit !== null && limit < 2.2 * Math.max(-low, high)) {
    high = Math.max(high, limit);
    if (row.limit !== "speed" || low < 0) low = Math.min(low, -limit);
  }
  const most = Math.max(0, ...(shown.samples[row.within] ?? []));
  if (most < 2.2 * Math.max(-low, high)) [low, high] = [Math.min(low, -most), Math.max(high, most)];
  const room = 0.08 * (high - low || 1);
  return [low - room, high + room];
}

/** Draw everything; gives what cursor and handles need to know of the places on the screen. */
export function draw(drawing, shown, onGrip) {
  const width = Math.max(320, Math.round(drawing.getBoundingClientRect().width) || 900); // that of the screen, so that letters keep their size
  const list = rowsOf(shown);
  const along = abscissa(shown);
  const x = along.of(shown.samples);
  const beside = curvesBeside(shown);
  const [start, end] = [Math.min(...x), Math.max(...x)];
  const across = (value) => LEFT + ((value - start) / (end - start || 1)) * (width - LEFT - RIGHT);
  const height = TOP + list.length * (ROW + GAP);
  drawing.replaceChildren();
  drawing.setAttribute("viewBox", `0 0 ${width} ${height}`);
  drawing.classList.toggle("infeasible", state.refusal !== null);
  const place = { width, start, end, x, across, list, along, left: LEFT, right: width - RIGHT, bottom: height - GAP, top: TOP, drawing };
  list.forEach((row, number) => {
    const top = TOP + number * (ROW + GAP);
    const [low, high] = span(row, shown, beside);
    const down = (value) => top + ROW * (1 - (Math.min(Math.max(value, low), high) - low) / (high - low));
    zones(drawing, shown, place, top);
    drawing.append(svg("rect", { class: "frame", x: LEFT, y: top, width: width - LEFT - RIGHT, height: ROW }));
    if (low < 0 && high > 0) drawing.append(svg("line", { class: "zero", x1: LEFT, x2: width - RIGHT, y1: down(0), y2: down(0) }));
    for (const tick of ticks(low, high)) drawing.append(svg("text", { class: "tick", x: LEFT - 5, y: down(tick) + 4, "text-anchor": "end" }, digits(tick)));
    drawing.append(svg("text", { class: "title", x: LEFT, y: top - 6 }, titleOf(row)));
    for (const { kind, samples } of beside) if (row.of(samples)) drawing.append(svg("path", { class: `curve ${kind}`, d: path(along.of(samples), row.of(samples), across, down) }));
    drawing.append(svg("path", { class: "curve", "data-row": row.name, d: path(x, row.of(shown.samples), across, down) }));
    if (shown.samples[row.within]) bounds(drawing, shown, row, { ...place, down, top, low, high });
    if (row.limit) limitLines(drawing, row, shown, { ...place, low, high, top, down, onGrip });
    marks(drawing, row.of(shown.samples), { ...place, down });
  });
  for (const tick of ticks(start, end, width < 500 ? 3 : 6)) drawing.append(svg("text", { class: "tick", x: across(tick), y: height - GAP + 14, "text-anchor": "middle" }, digits(tick)));
  drawing.append(svg("text", { class: "title", x: width - RIGHT, y: height - 3, "text-anchor": "end" }, `${word(along.name)} (${along.unit})`));
  grips(drawing, shown, place, onGrip);
  drawing.append(svg("line", { class: "cursor", id: "cursor", x1: -9, x2: -9, y1: TOP, y2: height - GAP }));
  return place;
}

/** Where a place on the master (m) stands along the plots. */
function acrossMaster(shown, place, metres) {
  const { x_m: x } = shown.samples;
  return place.across(place.x[x.reduce((best, value, i) => (Math.abs(value - metres) < Math.abs(x[best] - metres) ? i : best), 0)]);
}

function zones(drawing, shown, place, top) {
  for (const kind of ["sync", "shear"]) {
    for (const ends of shown.zones_m[kind]) {
      const [from, to] = ends.map((metres) => acrossMaster(shown, place, metres)).sort((a, b) => a - b);
      drawing.append(svg("rect", { class: kind === "sync" ? "zone" : "shear", x: from, y: top, width: to - from, height: ROW }));
    }
  }
}

/** What a handle tells who does not see it: its value, in words too, between nothing and as far as a slider goes. */
const valueOf = (value, told) => ({ "aria-valuemin": 0, "aria-valuenow": value, "aria-valuemax": 4 * value, "aria-valuetext": told });

const titleOf = (row) => (row.unit === "1" ? word(row.name) : `${word(row.name)} (${row.unit})`);

/** Height of a name at a plot's upper right: above it, or within it where the plot's title leaves no room. */
const heightOf = (name, row, { top, left, right }) => (6.4 * (titleOf(row).length + name.length + 2) < right - left ? top - 6 : top + 12);

/** Limits as lines with a handle; one that is far beyond the curve stands as a handle on the upper edge. */
function limitLines(drawing, row, shown, { low, high, top, down, left, right, onGrip }) {
  const limit = shown.limits[row.limit] * row.factor;
  const binding = shown.binding.includes(row.limit);
  const beyond = limit > high;
  const kind = binding ? " binding" : "";
  const told = withUnit(limit, row.unit);
  const text = binding ? `${word(row.name)} ${word("binds")}: ${told}` : `${word("limit")} ${told}`;
  for (const value of beyond ? [high] : [limit, -limit]) {
    if (value < low) continue;
    const at = { x1: left, x2: right, y1: down(value), y2: down(value) };
    if (!beyond) drawing.append(svg("line", { class: `limit${kind}`, ...at }));
    const handle = svg("rect", { class: "handle vertical", x: left, y: down(value) - 7, width: right - left, height: 14, tabindex: 0, role: "slider", "aria-label": `${word("limit")} ${word(row.name)}`, ...valueOf(limit, told), "data-path": `limits.${row.limit}` });
    onGrip(handle, { path: `limits.${row.limit}`, vertical: true, share: beyond ? 1 / ROW : ((high - low) / ROW / limit) * Math.sign(value) });
    drawing.append(handle);
  }
  const name = beyond ? `▴ ${text}` : text;
  const label = svg("text", { class: `limit-name${kind}`, x: right - 4, y: beyond ? heightOf(name, row, { top, left, right }) : down(limit) - 4, "text-anchor": "end" }, name);
  drawing.append(label);
}

/** What the motor gives at its speed, either way: a limit that changes along the cycle. */
function bounds(drawing, shown, row, { x, across, down, left, right, top, low, high }) {
  const most = shown.samples[row.within];
  const binding = shown.binding.includes("motor_torque") ? " binding" : "";
  const within = (value) => (value >= low && value <= high ? value : null);
  for (const sign of [1, -1]) drawing.append(svg("path", { class: `limit${binding}`, fill: "none", d: path(x, most.map((value) => within(sign * value)), across, down) }));
  const least = Math.min(...most);
  const told = least > high ? `▴ ${word("motor curve")} ${withUnit(least, row.unit)}` : binding ? `${word("motor curve")} ${word("binds")}` : word("motor curve");
  drawing.append(svg("text", { class: `limit-name${binding}`, x: right - 4, y: heightOf(told, row, { top, left, right }), "text-anchor": "end" }, told));
}

function marks(drawing, values, { x, across, down, width }) {
  for (const i of extremes(values)) {
    const at = across(x[i]);
    const left = at > width * 0.7;
    drawing.append(svg("circle", { class: "extreme", cx: at, cy: down(values[i]), r: 3 }));
    drawing.append(svg("text", { class: "mark", x: at + (left ? -6 : 6), y: down(values[i]) + (values[i] > 0 ? 13 : -5), "text-anchor": left ? "end" : "start" }, `${digits(values[i])} @ ${digits(x[i], 4)}`));
  }
}

/** Triangles above the plots: the end of the cycle is the cut length, the beginning of the sync zone its length. */
function grips(drawing, shown, place, onGrip) {
  const { x_m: x } = shown.samples;
  const length = x[x.length - 1] - x[0];
  const list = [{ path: "cut.length", name: "cut length", metres: length, at: x[x.length - 1], way: 1 }];
  const sync = shown.zones_m.sync;
  if (sync.length === 1) list.push({ path: "cut.sync_zone", name: "sync zone", metres: sync[0][1] - sync[0][0], at: sync[0][0], way: -1 });
  const places = list.map(({ at }) => acrossMaster(shown, place, at));
  list.forEach(({ path: key, name, metres, way }, number) => {
    const here = places[number];
    const room = here - Math.max(0, ...places.filter((other) => other < here));
    const told = withUnit(metres * lengthUnit().factor, lengthUnit().name);
    const whole = `${word(name)} ${told}`;
    const group = svg("g", { tabindex: 0, role: "slider", "aria-label": word(name), ...valueOf(metres, told), "data-path": key });
    group.append(svg("rect", { class: "handle", x: here - 7, y: TOP, width: 14, height: place.bottom - TOP }), svg("path", { class: "grip", d: `M${here - 9} 2h18l-9 15z` }));
    group.append(svg("text", { class: "mark", x: here - 13, y: 13, "text-anchor": "end" }, room > 6.4 * whole.length + 26 ? whole : room > 6.4 * told.length + 26 ? told : ""));
    onGrip(group, { path: key, vertical: false, share: (way * length) / metres / (place.right - place.left) });
    drawing.append(group);
  });
}
