// What stands beside the plots: checks, comparison, how far, map, tables, recipe, audit, machine.

import { blobOf, post } from "./api.js";
import * as machine from "./machine.js";
import { digits } from "./plots.js";
import { commit, state } from "./state.js";
import { quantity, values, withValue } from "./toml.js";
import { word } from "./words.js";

export const VIEWS = { checks, compare, limits, envelope, export: tables, recipe, audit, machine: (panel) => machine.show(panel) };

const make = (name, text, kind) => {
  const element = document.createElement(name);
  if (text !== undefined) element.textContent = text;
  if (kind) element.className = kind;
  return element;
};

function table(headings, lines) {
  const made = make("table");
  const head = made.createTHead().insertRow();
  for (const heading of headings) head.append(Object.assign(make("th", heading), { scope: "col" }));
  const body = made.createTBody();
  for (const line of lines) {
    const row = body.insertRow();
    for (const cell of line) row.append(typeof cell === "number" ? make("td", digits(cell), "number") : cell instanceof Node ? cell : make("td", cell ?? "–"));
  }
  return made;
}

const button = (text, press) => {
  const made = Object.assign(make("button", text), { type: "button" });
  made.addEventListener("click", press);
  return made;
};

const refused = (data) => make("p", data.message ?? "", "failed");

function checks(panel) {
  const proof = state.proof;
  if (!proof) {
    panel.replaceChildren(make("p", word(state.status)));
    return;
  }
  const { objective } = proof;
  const bound = objective.lower_bound === null ? "–" : `${digits(objective.lower_bound)} ${objective.unit}`;
  const head = table([word("objective"), word("value"), word("bound"), word("gap")], [[objective.name, `${digits(objective.value)} ${objective.unit}`, bound, objective.gap === null ? "–" : objective.gap.toExponential(1)]]);
  const list = table([word("check"), "", word("value"), word("limit"), ""], proof.checks.map((check) => [check.name, make("td", word(check.passed ? "passed" : "failed"), check.passed ? "" : "failed"), check.value, check.limit, check.unit]));
  panel.replaceChildren(head, list);
}

async function compare(panel) {
  panel.replaceChildren(make("p", "…"));
  const { ok, data } = await post("compare", { toml: state.text });
  if (!ok) return panel.replaceChildren(refused(data));
  const measures = ["peak_acceleration_m_per_s2", "rms_acceleration_m_per_s2", "peak_jerk_m_per_s3"];
  const number = (value) => (value === null ? "∞" : value);
  panel.replaceChildren(table([word("profile"), "m/s²", "RMS m/s²", "m/s³", "mm"], Object.entries(data.profiles).map(([name, each]) => [word(name), ...measures.map((measure) => number(each[measure])), number(each.servo?.shear_zone_error_mm ?? null)])));
}

async function limits(panel) {
  panel.replaceChildren(make("p", "…"));
  const { ok, data } = await post("limits", { toml: state.text });
  if (!ok) return panel.replaceChildren(refused(data));
  const lines = [];
  for (const [key, value] of Object.entries(data)) {
    if (typeof value === "number") lines.push([key, value]);
    else if (value && typeof value === "object") for (const [inner, each] of Object.entries(value)) if (typeof each === "number") lines.push([`${key}: ${inner}`, each]);
  }
  panel.replaceChildren(table(["", word("value")], lines));
}

function envelope(panel) {
  const place = make("div");
  panel.replaceChildren(button(word("draw"), async () => {
    place.replaceChildren(make("p", "…"));
    const { ok, data } = await post("envelope", { toml: state.text, points: 11 });
    if (!ok) return place.replaceChildren(refused(data));
    place.replaceChildren(map(data), make("p", word("click")));
  }), place);
}

function map(data) {
  const points = data.max_line_speed.map((row) => [row.cut_length_mm ?? row.length_mm, row.optimised_m_per_min ?? row.optimised]).filter(([x, y]) => x !== undefined && y !== null && y !== undefined);
  const [wide, high] = [Math.max(...points.map(([x]) => x)), 1.1 * Math.max(...points.map(([, y]) => y))];
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 400 260");
  const x = (value) => 40 + (value / wide) * 350;
  const y = (value) => 230 - (value / high) * 220;
  const add = (name, attributes, text) => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text) element.textContent = text;
    svg.append(element);
  };
  add("path", { class: "possible", d: `M${x(points[0][0])} 230${points.map(([a, b]) => `L${x(a)} ${y(b)}`).join("")}L${x(points[points.length - 1][0])} 230Z` });
  add("text", { class: "tick", x: 390, y: 250, "text-anchor": "end" }, `${word("cut length")} ${digits(wide)} mm`);
  add("text", { class: "tick", x: 40, y: 12 }, `${word("line speed")} ${digits(high)} m/min`);
  const here = [quantity(values(state.text)["cut.length"]), quantity(values(state.text)["cut.line_speed"])];
  if (here[0]?.unit === "mm" && here[1]?.unit === "m/min") add("circle", { class: "point", cx: x(here[0].number), cy: y(here[1].number), r: 5 });
  svg.addEventListener("click", (event) => {
    const box = svg.getBoundingClientRect();
    const length = ((((event.clientX - box.left) / box.width) * 400 - 40) / 350) * wide;
    const speed = ((230 - ((event.clientY - box.top) / box.height) * 260) / 220) * high;
    if (length > 0 && speed > 0) commit(withValue(withValue(state.text, "cut.length", JSON.stringify(`${digits(length)} mm`)), "cut.line_speed", JSON.stringify(`${digits(speed)} m/min`)));
  });
  return svg;
}

function chooser(names) {
  const select = make("select");
  for (const name of names) select.append(Object.assign(make("option", name), { value: name }));
  return select;
}

function links(contents, under) {
  const list = make("ul");
  for (const [path, base64] of Object.entries(contents)) {
    if (!path.startsWith(under)) continue;
    const link = Object.assign(make("a", path), { href: URL.createObjectURL(blobOf(base64, "application/octet-stream")), download: path.split("/").pop() });
    const item = make("li");
    item.append(link);
    list.append(item);
  }
  return list;
}

function tables(panel) {
  const select = chooser(state.targets);
  select.setAttribute("aria-label", word("target"));
  const place = make("div");
  panel.replaceChildren(select, button(word("write"), async () => {
    place.replaceChildren(make("p", "…"));
    const { ok, data } = await post("export", { toml: state.text, targets: [select.value] });
    if (!ok) return place.replaceChildren(refused(data));
    const rows = Object.entries(data.targets).map(([name, each]) => [name, each.knots, `${digits(each.position_error_m * 1e6)} µm`, word(each.passed === false ? "failed" : "passed")]);
    place.replaceChildren(table([word("target"), word("points"), word("error"), word("judgement")], rows), links(data.contents, "tables/"));
  }), place);
}

function recipe(panel) {
  const select = chooser(["en", "de", "zh"]);
  select.value = document.documentElement.lang;
  select.setAttribute("aria-label", word("language"));
  const target = chooser(state.targets);
  target.value = "csv";
  target.setAttribute("aria-label", word("target"));
  const place = make("div");
  panel.replaceChildren(select, target, button(word("write"), async () => {
    place.replaceChildren(make("p", "…"));
    const { ok, data } = await post("recipe", { toml: state.text, targets: [target.value], language: select.value });
    if (!ok) return place.replaceChildren(refused(data));
    const page = Object.keys(data.contents).find((path) => path.endsWith("recipe.pdf"));
    const frame = Object.assign(make("iframe"), { title: word("recipe"), src: URL.createObjectURL(blobOf(data.contents[page], "application/pdf")) });
    place.replaceChildren(links(data.contents, "recipe/"), frame);
  }), place);
}

function audit(panel) {
  const box = make("div", word("drop"), "drop");
  const input = Object.assign(make("input"), { type: "file" });
  input.setAttribute("aria-label", word("drop"));
  box.append(input);
  const place = make("div");
  const judge = async (file) => {
    place.replaceChildren(make("p", "…"));
    const bytes = new Uint8Array(await file.arrayBuffer());
    let text = "";
    for (let at = 0; at < bytes.length; at += 32768) text += String.fromCharCode(...bytes.subarray(at, at + 32768));
    const { ok, data } = await post("audit", { toml: state.text, name: file.name, base64: btoa(text) });
    if (!ok) return place.replaceChildren(refused(data));
    place.replaceChildren(table([word("check"), "", word("value"), word("limit")], (data.checks ?? []).map((check) => [check.name, make("td", word(check.passed ? "passed" : "failed"), check.passed ? "" : "failed"), check.value, check.limit])));
  };
  input.addEventListener("change", () => input.files[0] && judge(input.files[0]));
  box.addEventListener("dragover", (event) => { event.preventDefault(); box.classList.add("over"); });
  box.addEventListener("dragleave", () => box.classList.remove("over"));
  box.addEventListener("drop", (event) => { event.preventDefault(); box.classList.remove("over"); judge(event.dataTransfer.files[0]); });
  panel.replaceChildren(box, place);
}
