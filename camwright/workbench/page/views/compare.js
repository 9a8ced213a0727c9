// The optimum beside the standard laws: measures as a table, one of them as bars.

import { chooser, make, row, svg, table } from "../elements.js";
import { digits, shownSi } from "../numbers.js";
import { state } from "../state.js";
import { word } from "../words.js";
import { ask } from "./asking.js";

const MEASURES = {
  peak_acceleration: ["peak_acceleration_m_per_s2", "m/s^2"],
  rms_acceleration: ["rms_acceleration_m_per_s2", "m/s^2"],
  peak_jerk: ["peak_jerk_m_per_s3", "m/s^3"],
  rms_torque: ["rms_torque_N_m", "N m"],
  peak_torque: ["peak_torque_N_m", "N m"],
  energy: ["energy_J", "J"],
  "sync error": ["shear_zone_error_mm", "m", 1e-3],
};
const OF_MOTOR = ["rms_torque", "peak_torque", "energy"];

/** A profile's name; one that breaks a limit has a star. */
export const profileName = (name, within) => (within ? name : `${name} *`);

/** A measure of a profile as it is told; null where it is unbounded. */
function valueOf(each, [key, unit, scale = 1]) {
  const value = key in each ? each[key] : (each.motor?.[key] ?? each.servo?.[key] ?? null);
  return value === null ? null : shownSi(scale * value, unit).value;
}

export function show(panel) {
  ask(panel, "compare", { toml: state.text }, ({ profiles, sorted_by: first }) => {
    const names = Object.keys(profiles);
    const shown = Object.entries(MEASURES).filter(([name, measure]) => !OF_MOTOR.includes(name) || names.some((each) => valueOf(profiles[each], measure) !== null));
    const headings = shown.map(([name, [, unit]]) => `${word(name)} (${shownSi(1, unit).unit})`);
    const lines = names.map((name) => [profileName(word(name), profiles[name].within_limits), ...shown.map(([, measure]) => valueOf(profiles[name], measure) ?? make("td", "∞", "number"))]);
    const list = table([word("profile"), ...headings], lines);
    row(list, names.indexOf("optimised")).className = "own";
    const place = make("div");
    const choice = chooser(shown.map(([name]) => [name, word(name)]), word("value"), shown.some(([name]) => name === first) ? first : shown[0][0]);
    const draw = () => place.replaceChildren(bars(profiles, MEASURES[choice.value]));
    choice.addEventListener("change", draw);
    draw();
    return [list, make("p", `* ${word("beyond")}`), choice, place];
  });
}

/** Bars of a measure; what is unbounded has none, what breaks a limit is hatched. */
function bars(profiles, measure) {
  const { unit } = shownSi(1, measure[1]);
  const known = Object.entries(profiles).map(([name, each]) => ({ name, value: valueOf(each, measure), within: each.within_limits }));
  const most = Math.max(...known.map(({ value }) => value ?? 0)) || 1;
  const drawing = svg("svg", { viewBox: `0 0 460 ${known.length * 22 + 8}`, role: "img", "aria-label": word("compare") });
  known.forEach(({ name, value, within }, number) => {
    const top = number * 22 + 4;
    drawing.append(svg("text", { class: "mark", x: 150, y: top + 13, "text-anchor": "end" }, word(name)));
    drawing.append(svg("rect", { class: `bar ${name === "optimised" ? "own" : ""} ${within ? "" : "beyond"}`, x: 156, y: top, width: (230 * (value ?? 0)) / most, height: 17 }));
    drawing.append(svg("text", { class: "mark", x: 160 + (230 * (value ?? 0)) / most, y: top + 13 }, value === null ? "∞" : `${digits(value, 4)} ${unit}`));
  });
  return drawing;
}
