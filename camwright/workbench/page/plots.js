// Stacked plots over the master with one cursor; zones shaded, limits as lines that can be dragged, extremes marked.

import { state } from "./state.js";
import { word } from "./words.js";

const LEFT = 62, RIGHT = 14, ROW = 118, GAP = 30, TOP = 26;
let WIDTH = 900; // that of the screen, so that letters keep their size
const LIMIT = { speed: "speed", acceleration: "acceleration", jerk: "jerk" };

export const master = { unit: "mm" };

const make = (name, attributes, text) => {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
};

export const digits = (value) => (Number.isFinite(value) ? Number(value.toPrecision(5)).toString() : "–");

/** Factor from metres of the master to the unit that is shown. */
export function masterFactor(length, lineSpeed) {
  return { mm: 1e3, in: 1 / 0.0254, ms: 1e3 / lineSpeed, deg: 360 / length }[master.unit];
}

function rows(shown) {
  const turning = shown.slave_unit === "rad";
  const unit = turning ? "rad" : "m";
  const small = turning ? { factor: 180 / Math.PI, unit: "°" } : { factor: 1e3, unit: "mm" };
  return [
    { name: "correction", unit: small.unit, of: (s) => correction(s).map((each) => each * small.factor) },
    { name: "ratio", unit: turning ? "rad/m" : "1", of: (s) => s.ratio },
    { name: "speed", unit: `${unit}/s`, of: (s) => s.speed, limit: "speed" },
    { name: "acceleration", unit: `${unit}/s²`, of: (s) => s.acceleration, limit: "acceleration" },
    { name: "jerk", unit: `${unit}/s³`, of: (s) => s.jerk, limit: "jerk" },
  ];
}

/** What is left of the travel when an even one is taken out. */
function correction({ x_m: x, y }) {
  const last = x.length - 1;
  const even = (y[last] - y[0]) / (x[last] - x[0]);
  return y.map((each, i) => each - y[0] - even * (x[i] - x[0]));
}

function span(row, shown, others) {
  const all = [shown.samples, ...others.map((each) => each.samples)].flatMap((each) => row.of(each));
  let [low, high] = [Math.min(0, ...all), Math.max(0, ...all)];
  const limit = row.limit ? shown.limits[row.limit] : null;
  const reach = Math.max(-low, high);
  if (limit && limit < 2.2 * reach) {
    high = Math.max(high, limit);
    if (row.limit !== "speed") low = Math.min(low, -limit);
  }
  const room = 0.07 * (high - low || 1);
  return [low - room, high + room];
}

/** Draw everything; gives what the pointer needs to know of the places on the screen. */
export function draw(svg, shown, { onGrip }) {
  WIDTH = Math.max(320, Math.round(svg.getBoundingClientRect().width) || 900);
  const { x_m: x } = shown.samples;
  const [start, end] = [x[0], x[x.length - 1]];
  const others = [
    ...(state.ghost && state.ghost !== shown ? [{ ...state.ghost, kind: "ghost" }] : []),
    ...(state.pinned ? [{ ...state.pinned, kind: "pinned" }] : []),
  ].filter((each) => each.slave_unit === shown.slave_unit);
  const laws = Object.entries(shown.laws ?? {}).map(([kind, samples]) => ({ samples, kind }));
  const list = rows(shown);
  const height = TOP + list.length * (ROW + GAP);
  const across = (place) => LEFT + ((place - start) / (end - start)) * (WIDTH - LEFT - RIGHT);
  svg.replaceChildren();
  svg.setAttribute("viewBox", `0 0 ${WIDTH} ${height}`);
  svg.classList.toggle("infeasible", state.refusal !== null);
  const factor = masterFactor(end - start, lineSpeed(shown));
  list.forEach((row, number) => {
    const top = TOP + number * (ROW + GAP);
    const [low, high] = span(row, shown, [...others, ...laws.filter(() => row.name !== "jerk")]);
    const down = (value) => top + ROW * (1 - (value - low) / (high - low));
    for (const [from, to] of shown.zones_m.sync) svg.append(make("rect", { class: "zone", x: across(from), y: top, width: across(to) - across(from), height: ROW }));
    for (const [from, to] of shown.zones_m.shear) svg.append(make("rect", { class: "shear", x: across(from), y: top, width: across(to) - across(from), height: ROW }));
    svg.append(make("rect", { class: "axis", x: LEFT, y: top, width: WIDTH - LEFT - RIGHT, height: ROW, fill: "none" }));
    if (low < 0 && high > 0) svg.append(make("line", { class: "zero", x1: LEFT, x2: WIDTH - RIGHT, y1: down(0), y2: down(0) }));
    for (const tick of ticks(low, high)) svg.append(make("text", { class: "tick", x: LEFT - 5, y: down(tick) + 4, "text-anchor": "end" }, digits(tick)));
    svg.append(make("text", { class: "title", x: LEFT, y: top - 6 }, `${word(row.name)} (${row.unit})`));
    const path = (samples) => row.of(samples).map((value, i) => `${i ? "L" : "M"}${across(start + ((samples.x_m[i] - samples.x_m[0]) / (samples.x_m[samples.x_m.length - 1] - samples.x_m[0])) * (end - start)).toFixed(2)} ${clip(down(value), top).toFixed(2)}`).join("");
    for (const other of [...others, ...laws]) svg.append(make("path", { class: `curve ${other.kind}`, d: path(other.samples) }));
    svg.append(make("path", { class: "curve", d: path(shown.samples), "data-row": row.name }));
    if (row.limit) limitLines(svg, row, shown, { low, high, down, onGrip });
    marks(svg, row, shown, { across, down, factor });
  });
  const bottom = height - GAP + 14;
  for (const tick of ticks(start * factor, end * factor)) svg.append(make("text", { class: "tick", x: across(tick / factor), y: bottom, "text-anchor": "middle" }, digits(tick)));
  svg.append(make("text", { class: "title", x: WIDTH - RIGHT, y: height - 4, "text-anchor": "end" }, `${word("master")} (${master.unit === "deg" ? "°" : master.unit})`));
  grip(svg, across(end), height, "cut.length", word("cut length"), onGrip);
  const zone = shown.zones_m.sync[0];
  if (shown.zones_m.sync.length === 1) grip(svg, across(zone[0]), height, "cut.sync_zone", word("sync zone"), onGrip);
  svg.append(make("line", { class: "cursor", id: "cursor", x1: -9, x2: -9, y1: TOP, y2: height - GAP }));
  return { metresPerPixel: () => (end - start) / (((WIDTH - LEFT - RIGHT) / WIDTH) * svg.getBoundingClientRect().width), start, end, list, factor };
}

const clip = (value, top) => Math.min(Math.max(value, top), top + ROW);
export const lineSpeed = (shown) => {
  const i = shown.samples.ratio.findIndex((ratio) => Math.abs(ratio) > 1e-9);
  return shown.samples.speed[i] / shown.samples.ratio[i];
};

function ticks(low, high) {
  const raw = (high - low) / 4;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((each) => each * power).find((each) => each >= raw);
  const found = [];
  for (let at = Math.ceil(low / step) * step; at <= high; at += step) found.push(Math.abs(at) < step / 1e6 ? 0 : at);
  return found;
}

function limitLines(svg, row, shown, { low, high, down, onGrip }) {
  const limit = shown.limits[row.limit];
  const binding = shown.binding.includes(row.limit);
  for (const value of row.limit === "speed" ? [limit] : [limit, -limit]) {
    if (value < low || value > high) continue;
    const name = `limit${binding ? " binding" : ""}`;
    svg.append(make("line", { class: name, x1: LEFT, x2: WIDTH - RIGHT, y1: down(value), y2: down(value) }));
    const handle = make("line", { class: "handle vertical", x1: LEFT, x2: WIDTH - RIGHT, y1: down(value), y2: down(value), tabindex: 0, role: "slider", "aria-label": `${word("limit")} ${word(row.name)}`, "aria-valuenow": digits(limit), "data-path": `limits.${LIMIT[row.limit]}` });
    onGrip(handle, { path: `limits.${LIMIT[row.limit]}`, vertical: true, perPixel: ((high - low) / ROW) * Math.sign(value), value: limit });
    svg.append(handle);
  }
  if (limit > high) svg.append(make("text", { class: "tick", x: WIDTH - RIGHT, y: down(high) - 6, "text-anchor": "end" }, `${word("limit")} ${digits(limit)}`));
  else svg.append(make("text", { class: `limit-name${binding ? " binding" : ""}`, x: WIDTH - RIGHT - 4, y: down(limit) - 4, "text-anchor": "end" }, binding ? `${word(row.name)}: ${word("binds")}` : word("limit")));
}

function marks(svg, row, shown, { across, down, factor }) {
  const values = row.of(shown.samples);
  const greatest = values.reduce((best, value, i) => (Math.abs(value) > Math.abs(values[best]) ? i : best), 0);
  const at = shown.samples.x_m[greatest];
  svg.append(make("circle", { class: "extreme", cx: across(at), cy: down(values[greatest]), r: 3 }));
  const left = across(at) > WIDTH * 0.75;
  svg.append(make("text", { class: "mark", x: across(at) + (left ? -6 : 6), y: down(values[greatest]) + (values[greatest] > 0 ? -5 : 13), "text-anchor": left ? "end" : "start" }, `${digits(values[greatest])} @ ${digits(at * factor)}`));
}

function grip(svg, x, height, path, label, onGrip) {
  const group = make("g", { tabindex: 0, role: "slider", "aria-label": label, "data-path": path });
  group.append(make("line", { class: "handle", x1: x, x2: x, y1: TOP, y2: height - GAP }), make("path", { class: "grip", d: `M${x - 8} ${TOP - 26}h16l-8 14z` }));
  onGrip(group, { path, vertical: false });
  svg.append(group);
}

/** Put the cursor at a place on the screen; what it reads, as a text. */
export function read(svg, place, shown, clientX) {
  const box = svg.getBoundingClientRect();
  const x = ((clientX - box.left) / box.width) * WIDTH;
  if (x < LEFT || x > WIDTH - RIGHT) return "";
  const share = (x - LEFT) / (WIDTH - LEFT - RIGHT);
  const i = Math.round(share * (shown.samples.x_m.length - 1));
  const cursor = svg.querySelector("#cursor");
  cursor.setAttribute("x1", x);
  cursor.setAttribute("x2", x);
  const unit = master.unit === "deg" ? "°" : master.unit;
  return [`${word("master")} ${digits(shown.samples.x_m[i] * place.factor)} ${unit}`, ...place.list.map((row) => `${word(row.name)} ${digits(row.of(shown.samples)[i])} ${row.unit}`)].join(" · ");
}
