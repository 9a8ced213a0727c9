// What the servo makes of the cam: every sampling phase, the axis against the material, at any line speed of the band.

import { newestOnly, post } from "../api.js";
import { make, svg, table, waiting } from "../elements.js";
import { digits, lengthUnit, shownSi, speedUnit } from "../numbers.js";
import { path, plot } from "../scale.js";
import { state } from "../state.js";
import { word } from "../words.js";
import { noDesign } from "./asking.js";

let share = 1;

export function show(panel) {
  const { proof } = state;
  if (!proof) return panel.replaceChildren(noDesign());
  const label = make("label", `${word("line speed")} `);
  const slider = Object.assign(make("input"), { type: "range", min: 2, max: 150, step: 1, value: Math.round(100 * share), id: "servo-speed" });
  const told = make("output");
  label.append(slider, told);
  const [figures, over] = [make("div"), make("div")];
  const ask = newestOnly(async (curve) => {
    const { ok, data } = await post("servo", { design: proof.design, share, curve });
    if (state.proof !== proof || !figures.isConnected) return;
    if (!ok) return figures.replaceChildren(make("p", data.message, "failed"));
    told.textContent = ` ${digits(speedUnit().factor * data.line_speed_m_per_s, 4)} ${speedUnit().name} (${Math.round(100 * share)} %)`;
    slider.setAttribute("aria-valuetext", told.textContent);
    figures.replaceChildren(...drawn(data));
    if (curve) over.replaceChildren(overSpeed(data, proof));
  });
  slider.addEventListener("input", () => {
    share = slider.value / 100;
    ask(false);
    over.querySelector(".here")?.setAttribute("visibility", "hidden");
  });
  slider.addEventListener("change", () => ask(true));
  figures.append(waiting());
  panel.replaceChildren(label, figures, over);
  return ask(true);
}

function drawn(data) {
  const { factor, name } = lengthUnit();
  const tolerance = data.sync_tolerance_m * factor;
  const response = Object.entries(data.response).filter(([key]) => key !== "phases");
  const list = table(["", word("value"), ""], response.map(([key, value]) => {
    const shown = shownSi(value, "m");
    return [word(`servo.${key}`), shown.value, shown.unit];
  }));
  return [meeting(data, factor, name), errors(data, factor, name, null), errors(data, factor, name, 6 * tolerance), list];
}

/** Axis and command where they come onto the ideal line, from the start of the sync zone. */
function meeting(data, factor, unit) {
  const ends = [-0.15 * data.sync_zone_m, 0.6 * data.sync_zone_m].map((value) => value * factor);
  const line = (x) => x * data.sync_ratio;
  const made = plot({ x: ends, y: [Math.min(line(ends[0]) * 1.6, line(ends[0]) - 1e-9), line(ends[1]) * 1.05], xTitle: `${word("from sync")} (${unit})`, yTitle: `${word("tool")} (${unit})` });
  const { drawing, across, down } = made;
  const all = (list) => list.map((value) => value * factor);
  drawing.append(svg("path", { class: "ideal", d: `M${across(ends[0])} ${down(line(ends[0]))}L${across(ends[1])} ${down(line(ends[1]))}` }));
  for (const phase of data.meeting) drawing.append(svg("path", { class: "curve phase", d: path(all(phase.x_m), all(phase.axis_m), across, down) }));
  if (data.meeting[0].x_m.length) drawing.append(svg("path", { class: "command", d: path(all(data.meeting[0].x_m), all(data.meeting[0].command_m), across, down) }));
  const crossing = data.response.crossing;
  if (crossing !== null && crossing * factor <= ends[1]) drawing.append(svg("circle", { class: "crossing", cx: across(crossing * factor), cy: down(line(crossing * factor)), r: 4 }));
  return captioned(drawing, [["ideal", word("ideal")], ["command", word("command")], ["curve phase", `${word("axis")}, ${data.phases.length} ${word("phases")}`]]);
}

/** Sync error over the sync zone, whole or close to the tolerance; the shear zone shaded. */
function errors(data, factor, unit, close) {
  const tolerance = data.sync_tolerance_m * factor;
  const most = close ?? 1.08 * Math.max(2 * tolerance, ...data.phases.flatMap(({ error_m: error }) => error.map((value) => Math.abs(value) * factor)));
  const made = plot({ x: [0, data.sync_zone_m * factor], y: [-most, most], xTitle: `${word("from sync")} (${unit})`, yTitle: `${word(close ? "sync error close" : "sync error")} (${unit})`, height: 190 });
  const { drawing, across, down, left, right, top, bottom } = made;
  const [from, to] = data.shear_zone_m.map((value) => across(value * factor));
  drawing.prepend(svg("rect", { class: "shear", x: from, y: top, width: Math.max(to - from, 1), height: bottom - top }));
  for (const side of [1, -1]) drawing.append(svg("line", { class: "limit", x1: left, x2: right, y1: down(side * tolerance), y2: down(side * tolerance) }));
  const seen = (value) => (Math.abs(value * factor) <= most ? value * factor : null);
  for (const phase of data.phases) drawing.append(svg("path", { class: "curve phase", d: path(phase.x_m.map((value) => value * factor), phase.error_m.map(seen), across, down) }));
  return captioned(drawing, [["limit", word("sync tolerance")], ["shear", word("shear zone")]]);
}

/** The sync error in the shear zone over the line speed; released speeds shaded. */
function overSpeed(data, proof) {
  const { line_speed_m_per_s: speeds, error_m: error, worst_error_m: worst } = data.over_line_speed;
  const { factor, name } = lengthUnit();
  const pace = speedUnit();
  const tolerance = data.sync_tolerance_m * factor;
  const least = 1e-3 * tolerance;
  const most = 1.5 * Math.max(tolerance, ...worst.map((value) => value * factor));
  const made = plot({ x: [0, pace.factor * speeds[speeds.length - 1]], y: [least, most], xTitle: `${word("line speed")} (${pace.name})`, yTitle: `${word("shear_zone_error")} (${name})`, logarithmic: true, height: 200 });
  const { drawing, across, down, left, right, top, bottom } = made;
  for (const [low, high] of proof.speed_band) drawing.prepend(svg("rect", { class: "zone", x: across(pace.factor * low), y: top, width: across(pace.factor * Math.min(high, speeds[speeds.length - 1])) - across(pace.factor * low), height: bottom - top }));
  drawing.append(svg("line", { class: "limit", x1: left, x2: right, y1: down(tolerance), y2: down(tolerance) }));
  const along = speeds.map((value) => pace.factor * value);
  const curve = (list) => list.map((value) => Math.max(value * factor, least));
  if (worst.some((value, i) => value > error[i])) drawing.append(svg("path", { class: "curve phase", d: path(along, curve(worst), across, down) }));
  drawing.append(svg("path", { class: "curve", d: path(along, curve(error), across, down) }));
  const here = across(pace.factor * data.line_speed_m_per_s);
  drawing.append(svg("line", { class: "cursor here", x1: here, x2: here, y1: top, y2: bottom }));
  return captioned(drawing, [["curve", word("optimised")], ["limit", word("sync tolerance")], ["zone", word("released")]]);
}

function captioned(drawing, entries) {
  const figure = make("figure");
  const caption = make("figcaption");
  for (const [kind, text] of entries) {
    const entry = make("span", undefined, "entry");
    entry.append(make("i", undefined, `line ${kind}`), text);
    caption.append(entry);
  }
  drawing.setAttribute("role", "img");
  drawing.setAttribute("aria-label", entries.map(([, text]) => text).join(", "));
  figure.append(drawing, caption);
  return figure;
}
