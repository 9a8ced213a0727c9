// How fast and how short: of a perfect axis, and with the axis in tolerance.

import { button, make, table } from "../elements.js";
import { digits, lengthUnit, speedUnit } from "../numbers.js";
import { set, state } from "../state.js";
import { bindingName, word } from "../words.js";
import { ask } from "./asking.js";

export function show(panel) {
  ask(panel, "limits", { toml: state.text }, (data) => {
    const speed = data.highest_line_speed_m_per_s;
    const short = data.shortest_cut_mm;
    const [size, pace] = [lengthUnit(), speedUnit()];
    const down = (value, digitsKept) => Math.floor(value * 10 ** digitsKept) / 10 ** digitsKept;
    const up = (value, digitsKept) => Math.ceil(value * 10 ** digitsKept) / 10 ** digitsKept;
    const line = (name, sense, value, unit, path, binding) => {
      const cell = make("td", value === null ? "–" : undefined, "number");
      const told = `${digits(value, 6)} ${unit}`;
      if (value !== null) cell.append(Object.assign(button(told, () => set(path, JSON.stringify(`${value} ${unit}`))), { title: `${word("use")}: ${told}` }));
      return [`${word(name)}, ${word(sense)}`, cell, binding ? bindingName(binding) : "–"];
    };
    const faster = (value) => (value === null ? null : down(pace.factor * value, 1));
    const shorter = (value) => (value === null ? null : up(1e-3 * value * size.factor, size.name === "in" ? 3 : 1));
    const [perfect, real] = [data.binding, data.axis_in_tolerance_binding];
    const list = table(["", word("value"), word("what binds")], [
      line("highest line speed", "perfect axis", faster(speed.perfect_axis), pace.name, "cut.line_speed", perfect.line_speed),
      line("highest line speed", "axis in tolerance", faster(speed.axis_in_tolerance), pace.name, "cut.line_speed", real.line_speed),
      line("shortest cut", "perfect axis", shorter(short.perfect_axis), size.name, "cut.length", perfect.cut_length),
      line("shortest cut", "axis in tolerance", shorter(short.axis_in_tolerance), size.name, "cut.length", real.cut_length),
    ]);
    const lengths = Object.entries(data.minimum_cut_length_mm).filter(([, value]) => value !== null);
    const more = lengths.length ? [make("h3", word("minimum cut length")), table([word("by"), size.name], lengths.map(([name, value]) => [word(`minimum.${name}`), 1e-3 * value * size.factor]))] : [];
    return [list, ...more];
  });
}
