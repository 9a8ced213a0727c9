// A file from the machine: a table is judged, a recording tells its servo; either is laid over the plots.

import { post, sent } from "../api.js";
import { button, dropZone, make, table, waiting } from "../elements.js";
import { changed, commit, state } from "../state.js";
import { digits, lengthUnit, printed, shownSi, speedUnit } from "../numbers.js";
import { withValue } from "../toml.js";
import { checkName, word } from "../words.js";
import { ask } from "./asking.js";

const SERVO = { bandwidth_rad_per_s: ["bandwidth", "rad/s"], damping: ["damping", ""], position_gain_per_s: ["position_gain", "1/s"], sample_time_ms: ["sample_time", "ms"], dead_time_ms: ["dead_time", "ms"], velocity_feedforward: ["velocity_feedforward", ""] };

const MOST = 50; // cuts that are listed

export function show(panel) {
  const units = Object.assign(make("input"), { placeholder: "mm,deg", size: 8 });
  const label = make("label", `${word("units")} `);
  label.append(units);
  const [notes, place, more] = [make("div"), make("div"), make("div")];
  const take = async (file) => {
    const body = { toml: state.text, ...(await sent(file)), ...(units.value ? { units: units.value } : {}), ...(state.proof ? { design: state.proof.design } : {}) };
    more.replaceChildren();
    notes.replaceChildren(waiting());
    const { ok, data } = await post("overlay", body);
    if (!ok) return notes.replaceChildren(make("p", data.message, "failed"));
    state.overlay = { name: file.name, ...data };
    changed("drawn");
    notes.replaceChildren(make("p", word(data.kind === "trace" ? "laid trace" : "laid table")), ...data.notes.map((note) => make("p", note)));
    if (data.kind === "table") return ask(place, "audit", body, judged);
    ask(more, "identify", body, servo);
    return ask(place, "trace", body, cuts);
  };
  panel.replaceChildren(dropZone(word("drop"), word("too large"), "", take), label, notes, place, more);
}

function judged(data) {
  const save = (value) => (value === null ? "–" : `${digits(100 * value, 3)} %`);
  const measures = [["peak_acceleration", "peak_acceleration_m_per_s2"], ["rms_acceleration", "rms_acceleration_m_per_s2"]];
  const beside = table(["", word("this cam"), word("optimised"), word("saving")], measures.map(([name, key]) => [`${word(name)} (${shownSi(1, "m/s^2").unit})`, shownSi(data.profile[key], "m/s^2").value, shownSi(data.optimum[key], "m/s^2").value, save(data.saving[`${name}_rel`])]));
  const checks = table([word("check"), "", word("value"), word("limit"), ""], data.checks.map((check) => {
    const [value, limit] = [shownSi(check.value, check.unit), shownSi(check.limit, check.unit)];
    return [checkName(check.name), make("td", word(check.passed ? "passed" : "failed"), check.passed ? "passed" : "failed"), value.value, limit.value, value.unit];
  }));
  return [beside, checks];
}

/** Each cut of a recorded run: by how much the tool missed, and what kind of error that is. */
function cuts(data) {
  const { total } = data.errors;
  const [size, pace] = [lengthUnit(), speedUnit()];
  const told = table([word("sync error"), size.name], [["offset", total.offset_mm], ["drift", total.drift_mm_per_cut], ["scatter", total.scatter_mm]].map(([name, value]) => [word(name), shownSi(1e-3 * value, "m").value]));
  const length = (value) => (value === null ? null : shownSi(1e-3 * value, "m").value);
  const list = table([word("cut number"), pace.name, `${word("sync error")} (${size.name})`, `${word("length")} (${size.name})`], data.cuts.slice(0, MOST).map((cut) => [cut.number, pace.factor * cut.line_speed_m_per_s, length(cut.sync_error_mm), length(cut.length_mm)]));
  const verdict = make("p", word(data.passed ? "passed" : "failed"), data.passed ? "passed" : "failed");
  return [verdict, ...data.causes.map((cause) => make("p", cause)), told, list];
}

/** The servo of a recording, and a button that writes it into the job. */
function servo(data) {
  const lines = Object.entries(SERVO).filter(([key]) => data[key] !== undefined);
  const list = table([word("servo"), word("value"), "", "95 %"], lines.map(([key, [name, unit]]) => {
    const bounds = data.confidence[key];
    return [word(`field.servo.${name}`), data[key], printed(unit), bounds ? bounds.map((value) => digits(value, 4)).join(" … ") : "–"];
  }));
  const use = () => commit(lines.reduce((text, [key, [name, unit]]) => {
    const value = Number(data[key].toPrecision(6));
    return withValue(text, `servo.${name}`, unit ? JSON.stringify(`${value} ${unit}`) : String(value));
  }, state.text));
  return [list, make("p", `${word("fit")} ${digits(data.fit, 6)}`), button(word("use servo"), use), ...data.notes.map((note) => make("p", note))];
}
