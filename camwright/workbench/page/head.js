// The head of the page: the badge that says what the plots are, and the refusal with its ways out.

import { button, make } from "./elements.js";
import { withUnit } from "./numbers.js";
import { set, state } from "./state.js";
import { checkName, word } from "./words.js";

const PLACE = { line_speed: "cut.line_speed", length: "cut.length", sync_zone: "cut.sync_zone", stroke: "machine.stroke" };
const KIND = { proved: "proved", failed: "failed", infeasible: "failed", faulty: "failed", gone: "failed" };

export function badge(shown) {
  const { proof, drawn, status } = state;
  const objective = status === "proved" || status === "failed" ? proof?.objective : status === "preview" || status === "proving" ? drawn?.objective : null;
  const failed = status === "failed" ? `: ${proof.checks.filter((check) => !check.passed).map((check) => checkName(check.name)).join(", ")}` : "";
  const stand = (status === "preview" || status === "proving") && drawn && !drawn.exact ? ` (${word("stands in")})` : "";
  shown.className = KIND[status] ?? "";
  shown.textContent = `${word(status)}${failed}${objective ? `: ${word(objective.name)} ${withUnit(objective.value, objective.unit)}` : ""}${stand}`;
}

/** The refusal as the command line words it; each of its ways out is a button. */
export function refusal(box) {
  const data = state.refusal;
  box.hidden = data === null;
  if (data === null) return;
  box.replaceChildren(...data.message.split("\n").map((line) => make("p", line)));
  if (data.suggestions?.length) box.append(make("span", `${word("what works")} `), ...data.suggestions.map(wayOut));
}

/** A change of the job that works, as a button. */
export function wayOut({ change, value, unit }) {
  const path = PLACE[change] ?? `limits.${change}`;
  const text = change === "reversal" ? "true" : JSON.stringify(`${value} ${unit}`);
  return button(`${path.split(".")[1].replaceAll("_", " ")} = ${change === "reversal" ? word("yes") : withUnit(value, unit)}`, () => set(path, text));
}
