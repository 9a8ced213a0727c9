// The rule bender: a drawing is bent, the bent rule lies over it, with bends, checks and warnings.

import { sent, textOf } from "../api.js";
import { chooser, dropZone, make, table } from "../elements.js";
import { digits } from "../numbers.js";
import { word } from "../words.js";
import { ask } from "./asking.js";
import { links } from "./files.js";

const MOST = 60; // rows of bends that are shown

export function show(panel) {
  const place = make("div");
  let [drawing, bender] = [null, null];
  const [accept, reverse] = ["accept collisions", "reverse"].map((name) => flag(name));
  const bend = async () => {
    if (!drawing) return;
    const options = { accept_collisions: accept.checked, reverse: reverse.checked, language: document.documentElement.lang };
    ask(place, "bend", { ...(await sent(drawing)), ...(bender ? { toml: await bender.text() } : {}), ...options }, bent);
  };
  const take = (file) => {
    drawing = file;
    bend();
  };
  for (const box of [accept, reverse]) box.addEventListener("change", bend);
  const job = make("details");
  job.append(make("summary", word("bender job")), dropZone(word("drop bender"), word("too large"), ".toml", (file) => { bender = file; job.firstChild.textContent = `${word("bender job")}: ${file.name}`; bend(); }));
  panel.replaceChildren(dropZone(word("drop drawing"), word("too large"), ".dxf", take), ...[accept, reverse].map((box) => box.parentElement), job, place);
}

/** A choice of the bender, off at first: its box, in a label that names it. */
function flag(name) {
  const box = Object.assign(make("input"), { type: "checkbox" });
  const label = make("label");
  label.append(box, ` ${word(name)}`);
  return box;
}

function bent(data) {
  const names = data.programs.map(({ file }) => file.split("/").pop().replace(/\.nc$/, ""));
  const facts = table(["", ""], [
    [word("drawing"), `${data.size_mm.map((side) => digits(side, 6)).join(" × ")} mm`],
    [word("outlines"), String(data.outlines)],
    [word("bends"), String(data.bends)],
    [word("bend deviation"), `${digits(data.deviation_mm, 3)} mm`],
    [word("closing error"), data.closing_error_mm === null ? word("open") : `${digits(data.closing_error_mm, 3)} mm`],
    [word("cycle time"), `${digits(data.cycle_time_s, 4)} s (${word("one after another")}: ${digits(data.baseline_cycle_time_s, 4)} s)`],
    [word("judgement"), make("td", word(data.passed ? "passed" : "failed"), data.passed ? "passed" : "failed")],
  ]);
  const warnings = make("ul", undefined, "warnings");
  warnings.append(...data.warnings.map((text) => make("li", text)));
  const choice = chooser(names, word("outline"));
  const place = make("div");
  const draw = () => place.replaceChildren(...outline(data.contents, choice.value));
  choice.addEventListener("change", draw);
  draw();
  return [facts, warnings, choice, place, links(data.contents, "bent/")];
}

/** The bent rule over the drawing as the command draws it, and the bends. */
function outline(contents, name) {
  const parts = [];
  for (const kind of ["proof", "times"]) {
    const drawing = contents[`bent/${name}-${kind}.svg`];
    if (drawing) parts.push(Object.assign(make("img"), { src: `data:image/svg+xml;base64,${drawing}`, alt: `${name}: ${word(`bender.${kind}`)}` }));
  }
  const lines = textOf(contents[`bent/${name}-bends.csv`]).trim().split("\n").map((line) => line.split(","));
  const columns = ["bend", "line", "feed_mm", "workpiece_angle_deg", "radius_mm", "mould_angle_deg"];
  const at = columns.map((column) => lines[0].indexOf(column));
  const cell = (text) => (text === "" ? "–" : Number.isFinite(Number(text)) ? Number(text) : text);
  const rows = lines.slice(1, MOST + 1).map((line) => at.map((i) => cell(line[i])));
  const more = lines.length - 1 - MOST;
  const list = make("details");
  list.append(make("summary", `${word("bends")}: ${name}`), table(columns.map((column) => word(`bends.${column}`)), rows));
  if (more > 0) list.append(make("p", `… ${more}`));
  return [...parts, list];
}
