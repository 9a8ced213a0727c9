// Cut length against line speed: what is possible. A click or the arrow keys set the working point.

import { button, make, onPress, svg } from "../elements.js";
import { digits } from "../numbers.js";
import { plot } from "../scale.js";
import { commit, state } from "../state.js";
import { withValue } from "../toml.js";
import { word } from "../words.js";
import { ask } from "./asking.js";

const EDGES = { perfect_axis: "", axis_in_tolerance: "pinned", linear: "law linear_return", quintic: "law poly_3_4_5" };

export function show(panel) {
  const place = make("div");
  panel.replaceChildren(button(word("draw"), () => ask(place, "envelope", { toml: state.text, points: 11 }, draw)), place);
}

function edgesOf(data) {
  const found = Object.fromEntries(Object.entries(data.edges).map(([name, list]) => [name, list.map((each) => [each.length_mm, each.line_speed_m_per_min]).filter(([, speed]) => speed !== null)]));
  return { ...found, linear: data.max_line_speed.map((each) => [each.length_mm, each.linear_m_per_min]).filter(([, speed]) => speed !== null) };
}

function draw(data) {
  const edges = edgesOf(data);
  const points = Object.values(edges).flat();
  const { samples, line_speed_m_per_s: line } = state.drawn;
  let here = [1e3 * (samples.x_m[samples.x_m.length - 1] - samples.x_m[0]), 60 * line];
  const all = [...points, here];
  const most = (order) => Math.max(...all.map((each) => each[order]));
  const { drawing, across, down, inverse, bottom } = plot({ x: [Math.min(...all.map(([x]) => x)) * 0.95, most(0)], y: [0, 1.08 * most(1)], height: 320, xTitle: `${word("cut length")} (mm)`, yTitle: `${word("line speed")} (m/min)` });
  const trace = (list) => list.map(([x, y], i) => `${i ? "L" : "M"}${across(x).toFixed(1)} ${down(y).toFixed(1)}`).join("");
  const area = edges.perfect_axis;
  drawing.append(svg("path", { class: "possible", d: `M${across(area[0][0])} ${bottom}L${trace(area).slice(1)}L${across(area[area.length - 1][0])} ${bottom}Z` }));
  for (const [name, kind] of Object.entries(EDGES)) if (edges[name]?.length) drawing.append(svg("path", { class: `curve ${kind}`, d: trace(edges[name]) }));
  const spot = svg("circle", { class: "point", r: 6, tabindex: 0, role: "button", "aria-label": word("working point") });
  const put = ([length, speed]) => {
    here = [Math.max(length, 1), Math.max(speed, 0.1)];
    spot.setAttribute("cx", across(here[0]));
    spot.setAttribute("cy", down(here[1]));
    told.textContent = `${digits(here[0], 4)} mm, ${digits(here[1], 4)} m/min`;
  };
  const told = Object.assign(make("p"), { role: "status" });
  const take = () => commit(withValue(withValue(state.text, "cut.length", JSON.stringify(`${Number(here[0].toPrecision(4))} mm`)), "cut.line_speed", JSON.stringify(`${Number(here[1].toPrecision(4))} m/min`)));
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
