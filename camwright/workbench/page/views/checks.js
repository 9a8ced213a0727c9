// The proof: objective beside its bound, every check, the line speeds that the cam is released for, remedies.

import { make, row, table } from "../elements.js";
import { digits, shownSi, speedUnit, toldSi } from "../numbers.js";
import { state } from "../state.js";
import { wayOut } from "../head.js";
import { checkName, word } from "../words.js";
import { ask, noDesign } from "./asking.js";

export function show(panel) {
  const { proof } = state;
  if (!proof) return panel.replaceChildren(noDesign());
  const { objective } = proof;
  const bound = objective.lower_bound === null ? "–" : toldSi(objective.lower_bound, objective.unit);
  const gap = objective.gap === null ? "–" : `${digits(100 * objective.gap, 2)} %`;
  const head = table([word("objective"), word("value"), word("bound"), word("gap")], [[word(objective.name), toldSi(objective.value, objective.unit), bound, gap]]);
  const lines = proof.checks.map((check) => {
    const [value, limit] = [shownSi(check.value, check.unit), shownSi(check.limit, check.unit)];
    return [checkName(check.name), make("td", word(check.passed ? "passed" : "failed"), check.passed ? "passed" : "failed"), value.value, limit.value, value.unit];
  });
  const list = table([word("check"), "", word("value"), word("limit"), ""], lines);
  proof.checks.forEach((check, number) => { row(list, number).title = check.source; });
  if (proof.passed) return panel.replaceChildren(head, released(proof), list);
  const ways = make("p");
  panel.replaceChildren(head, ways, released(proof), list);
  return ask(ways, "design", { toml: state.text }, ({ remedies }) => waysOut(remedies)); // what failed is told before
}

function released({ speed_band: band }) {
  const { factor, name } = speedUnit();
  const speed = (value) => digits(factor * value, 4);
  if (!band.length) return make("p", word("released nowhere"), "failed");
  return make("p", `${word("released")}: ${band.map(([low, high]) => `${speed(low)} … ${speed(high)}`).join(", ")} ${name}`);
}

function waysOut(list) {
  return list.length ? [`${word("what works")} `, ...list.map(wayOut)] : word("nothing works");
}
