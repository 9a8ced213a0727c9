// Cut length against line speed: what is possible. A click or the arrow keys set the working point.

import { button, make, onPress, svg } from "../elements.js";
import { digits, lengthUnit, speedUnit } from "../numbers.js";
import { plot } from "../scale.js";
import { commit, state } from "../state.js";
import { withValue, written } from "../toml.js";
import { word } from "../words.js";
import { ask } from "./asking.js";

const EDGES = { perfect_axis: "", axis_in_tolerance: "pinned", linear: "law linear_return", quintic: "law poly_3_4_5" };

export function show(panel) {
  const place = make("div");
  panel.replaceChildren(button(word("draw"), () => ask(place, "envelope", { toml: state.text, points: 11 }, draw)), place);
}

function edgesOf(data) {
  const [size, pace] = [1e-3 * lengthUnit().factor, speedUnit().factor / 60]; // of a millimetre, and of a metre a minute
  const points = (list, key) => list.filter((each) => each[key] !== null).map((each) => [size * each.length_mm, pace * each[key]]);
  const found = Object.fromEntries(Object.entries(data.edges).map(([name, list]) => [name, points(list, "line_speed_m_per_min")]));
  return { ...found, linear: points(data.max_line_speed, "linear_m_per_min") };
}

function draw(data) {
  const edges = edgesOf(data);
  const units = [lengthUnit().name, speedUnit().name];
  const points = Object.values(edges).flat();
  const { samples, line_speed_m_per_s: line } = state.drawn;
  let here = [lengthUnit().factor * (samples.x_m[samples.x_m.length - 1] - samples.x_m[0]), speedUnit().factor * line];
  const all = [...points, here];
  const most = (order) => Math.max(...all.map((each) => each[order]));
  const { drawing, across, down, inverse, bottom } = plot({ x: [Math.min(...all.map(([x]) => x)) * 0.95, most(0)], y: [0, 1.08 * most(1)], height: 320, xTitle: `${word("cut length")} (${units[0]})`, yTitle: `${word("line speed")} (${units[1]})` });
  const trace = (list) => list.map(([x, y], i) => `${i ? "L" : "M"}${across(x).toFixed(1)} ${down(y).toFixed(1)}`).join("");
  const area = edges.perfect_axis;
  drawing.append(svg("path", { class: "possible", d: `M${across(area[0][0])} ${bottom}L${trace(area).slice(1)}L${across(area[area.length - 1][0])} ${bottom}Z` }));
  for (const [name, kind] of Object.entries(EDGES)) if (edges[name]?.length) drawing.append(svg("path", { class: `curve ${kind}`, d: trace(edges[name]) }));
  const spot = svg("circle", { class: "point", r: 6, tabindex: 0, role: "button", "aria-label": word("working point") });
  const put = ([length, speed]) => {
    here = [Math.max(length, 1), Math.max(speed, 0.1)];
    spot.setAttribute("cx", across(here[0]));
    spot.setAttribute("cy", down(here[1]));
    told.textContent = here.map((value, order) => `${digits(value, 4)} ${units[order]}`).join(", ");
  };
  const told = Object.assign(make("p"), { role: "status" });
  const take = () => commit(["cut.length", "cut.line_speed"].reduce((text, path, order) => withValue(text, path, written(here[order], units[order])), state.text));
  put(here);
  drawing.append(spot);
  drawing.addEventListener("click", (event) => {
    const box = drawing.getBoundingClientRect();
    const { width, height } = drawing.viewBox.baseVal;
    put(inverse(((event.clientX - box.left) / box.width) * width, ((event.clientY - box.top) / box.height) * height));
    take();
  });
  spot.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [0.99, 1], ArrowRight: [1.01, 1], ArrowUp: [1, 1.01], ArrowDown: [1, 0.99] }[event.key];
    if (step) put([here[0] * step[0], here[1] * step[1]]);
    if (step) event.preventDefault();
  });
  onPress(spot, take);
  return [figure(drawing, edges), told, make("p", word("click"))];
}

function figure(drawing, edges) {
  drawing.setAttribute("role", "group");
  drawing.setAttribute("aria-label", word("envelope"));
  const made = make("figure");
  const caption = make("figcaption");
  for (const [name, kind] of Object.entries(EDGES)) {
    if (!edges[name]?.length) continue;
    const entry = make("span", undefined, "entry");
    entry.append(make("i", undefined, `line curve ${kind}`), word(`edge.${name}`));
    caption.append(entry);
  }
  made.append(drawing, caption);
  return made;
}
