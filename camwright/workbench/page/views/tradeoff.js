// What each objective costs in the others: every optimum and law as a point between two measures, and as a table.

import { chooser, make, onPress, row, svg, table } from "../elements.js";
import { digits, shownSi } from "../numbers.js";
import { plot } from "../scale.js";
import { set, state } from "../state.js";
import { word } from "../words.js";
import { ask } from "./asking.js";
import { profileName } from "./compare.js";

export function show(panel) {
  ask(panel, "compare", { toml: state.text, objectives: true }, (data) => {
    const names = Object.keys(data.measures);
    const second = names.find((name) => name !== data.sorted_by) ?? data.sorted_by;
    const [x, y] = [data.sorted_by, second].map((value) => chooser(names.map((name) => [name, word(name)]), word("value"), value));
    const place = make("div");
    const draw = () => place.replaceChildren(scatter(data, x.value, y.value));
    x.addEventListener("change", draw);
    y.addEventListener("change", draw);
    draw();
    const choice = make("p");
    choice.append(x, " × ", y);
    return [choice, place, costs(data, names), make("p", `${word("costs")} * ${word("beyond")}`), ...data.failed.map((each) => make("p", `${word(each.name)}: ${each.reason}`, "failed"))];
  });
}

function costs(data, names) {
  const cell = (each, name) => {
    const cost = each.cost[name];
    return make("td", cost === null ? "∞" : digits(cost, 3), each.within_limits && cost !== null && cost < 1.0005 ? "number best" : "number");
  };
  const list = table([word("profile"), ...names.map((name) => `${word(name)} (${shownSi(1, data.measures[name].unit).unit})`)], data.profiles.map((each) => [
    profileName(word(each.name), each.within_limits), ...names.map((name) => cell(each, name)),
  ]));
  data.profiles.forEach((each, number) => { if (each.kind === "objective") row(list, number).className = "own"; });
  return list;
}

/** The name of a disc beside it, where no other name stands; none where there is no room: the disc tells it too. */
function nameAt(text, x, y, { top, bottom }, named) {
  const width = [...text].reduce((sum, sign) => sum + (sign > "\u2e80" ? 11.5 : 6.4), 0);
  const left = x > 300;
  const from = left ? x - 9 - width : x + 9;
  for (const below of [-6, 14, -19, 27, -32, 40]) {
    const box = [from, y + below - 11, from + width, y + below + 2];
    const free = box[1] >= top - 2 && box[3] <= bottom && named.every((other) => box[0] > other[2] || box[2] < other[0] || box[1] > other[3] || box[3] < other[1]);
    if (!free) continue;
    named.push(box);
    return [svg("text", { class: "mark", x: left ? x - 9 : x + 9, y: y + below, "text-anchor": left ? "end" : "start" }, text)];
  }
  return [];
}

/** Points between two measures; an optimum is a disc that a click makes the job's objective. */
function scatter(data, first, second) {
  const points = data.profiles.map((each) => ({ ...each, at: [first, second].map((name) => shownSi(each.values[name], data.measures[name].unit).value) })).filter(({ at }) => at.every((value) => value !== null));
  const ends = (order) => {
    const all = points.map(({ at }) => at[order]);
    const room = 0.12 * (Math.max(...all) - Math.min(...all) || 1);
    return [Math.min(...all) - room, Math.max(...all) + room];
  };
  const unit = (name) => shownSi(1, data.measures[name].unit).unit;
  const made = plot({ x: ends(0), y: ends(1), xTitle: `${word(first)} (${unit(first)})`, yTitle: `${word(second)} (${unit(second)})` });
  made.drawing.setAttribute("role", "group");
  made.drawing.setAttribute("aria-label", word("tradeoff"));
  const named = points.map(({ at }) => [made.across(at[0]) - 6, made.down(at[1]) - 6, made.across(at[0]) + 6, made.down(at[1]) + 6]); // and discs
  for (const { name, kind, at, within_limits: within } of points) {
    const [x, y] = [made.across(at[0]), made.down(at[1])];
    const own = kind === "objective";
    const mark = svg("circle", { class: `spot ${own ? "own" : ""} ${within ? "" : "beyond"}`, cx: x, cy: y, r: own ? 6 : 4 });
    mark.append(svg("title", {}, `${word(name)}: ${digits(at[0])} ${unit(first)}, ${digits(at[1])} ${unit(second)}`));
    made.drawing.append(mark);
    if (!own) continue;
    const choose = () => set("objective.minimise", JSON.stringify(name));
    for (const [attribute, value] of [["tabindex", 0], ["role", "button"], ["aria-label", `${word("minimise")}: ${word(name)}`]]) mark.setAttribute(attribute, value);
    mark.addEventListener("click", choose);
    onPress(mark, choose);
    made.drawing.append(...nameAt(word(name), x, y, made, named));
  }
  return made.drawing;
}
