// What each objective costs in the others: every optimum and law as a point between two measures, and as a table.

import { chooser, make, row, svg, table } from "../elements.js";
import { digits, printed } from "../numbers.js";
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
  const list = table([word("profile"), ...names.map((name) => `${word(name)} (${printed(data.measures[name].unit)})`)], data.profiles.map((each) => [
    profileName(word(each.name), each.within_limits), ...names.map((name) => cell(each, name)),
  ]));
  data.profiles.forEach((each, number) => { if (each.kind === "objective") row(list, number).className = "own"; });
  return list;
}

/** Points between two measures; an optimum is a disc that a click makes the job's objective. */
function scatter(data, first, second) {
  const points = data.profiles.map((each) => ({ ...each, at: [each.values[first], each.values[second]] })).filter(({ at }) => at.every((value) => value !== null));
  const ends = (order) => {
    const all = points.map(({ at }) => at[order]);
    const room = 0.12 * (Math.max(...all) - Math.min(...all) || 1);
    return [Math.min(...all) - room, Math.max(...all) + room];
  };
  const unit = (name) => printed(data.measures[name].unit);
  const made = plot({ x: ends(0), y: ends(1), xTitle: `${word(first)} (${unit(first)})`, yTitle: `${word(second)} (${unit(second)})` });
  made.drawing.setAttribute("role", "group");
  made.drawing.setAttribute("aria-label", word("tradeoff"));
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
    mark.addEventListener("keydown", (event) => event.key === "Enter" && choose());
    made.drawing.append(svg("text", { class: "mark", x: x + (x > 300 ? -9 : 9), y: y - 6, "text-anchor": x > 300 ? "end" : "start" }, word(name)));
  }
  return made.drawing;
}
