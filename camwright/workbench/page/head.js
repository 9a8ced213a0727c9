// The head of the page: the badge that says what the plots are, and the refusal with its ways out.

import { button, make } from "./elements.js";
import { toldSi, withUnit } from "./numbers.js";
import { commit, state } from "./state.js";
import { plain, withValue } from "./toml.js";
import { checkName, word } from "./words.js";

const TABLES = { cut: ["line_speed", "length", "sync_zone", "sync_tolerance"], machine: ["stroke"], objective: ["servo_aware", "command", "minimise", "line_speeds"] };
const TRUTHS = ["servo_aware", "reversal"];
const KIND = { proved: "proved", failed: "failed", infeasible: "failed", faulty: "failed", gone: "failed" };

export function badge(shown) {
  const { proof, drawn, status } = state;
  const objective = status === "proved" || status === "failed" ? proof?.objective : status === "preview" || status === "proving" ? drawn?.objective : null;
  const failed = status === "failed" ? `: ${proof.checks.filter((check) => !check.passed).map((check) => checkName(check.name)).join(", ")}` : "";
  const stand = (status === "preview" || status === "proving") && drawn && !drawn.exact ? ` (${word("stands in")})` : "";
  shown.className = KIND[status] ?? "";
  shown.textContent = `${word(status)}${failed}${objective ? `: ${word(objective.name)} ${toldSi(objective.value, objective.unit)}` : ""}${stand}`;
}

/** The refusal as the command line words it; each of its ways out is a button. */
export function refusal(box) {
  const data = state.refusal;
  box.hidden = data === null;
  if (data === null) return;
  box.replaceChildren(...data.message.split("\n").map((line) => make("p", line)));
  if (data.suggestions?.length) box.append(make("span", `${word("what works")} `), ...data.suggestions.map(wayOut));
}

/** What a change writes into the job: values by their places. */
function edits(change, value, unit) {
  const table = Object.keys(TABLES).find((name) => TABLES[name].includes(change)) ?? "limits";
  const path = change.includes(".") ? change : `${table}.${change}`;
  if (change === "command") return { "objective.servo_aware": "true", [path]: '"shaped"' };
  if (change === "line_speeds") return { [path]: `["${value} ${unit}", "100 %"]` };
  if (TRUTHS.includes(change)) return { [path]: "true" };
  return { [path]: JSON.stringify(unit ? `${value} ${unit}` : value) };
}

/** A change of the job that works, as a button: the change is the text's, the name the language's. */
export function wayOut({ change, value, unit }) {
  const all = Object.entries(edits(change, value, unit));
  const [path, text] = all[all.length - 1];
  const told = TRUTHS.includes(change) ? word("yes") : change === "line_speeds" ? `${withUnit(value, unit)} …` : unit ? withUnit(value, unit) : word(plain(text));
  return button(`${word(`field.${path}`)} = ${told}`, () => commit(all.reduce((made, [place, written]) => withValue(made, place, written), state.text), "release"));
}
