// Tables for drives, as the command line writes them.

import { button, chooser, make, table } from "../elements.js";
import { state } from "../state.js";
import { word } from "../words.js";
import { ask } from "./asking.js";
import { links } from "./files.js";

export function show(panel) {
  const select = chooser(state.targets, word("target"));
  const place = make("div");
  const write = () => ask(place, "export", { toml: state.text, targets: [select.value] }, (data) => {
    const rows = Object.entries(data.targets).map(([name, each]) => [name, each.knots, each.position_error_m * 1e6, make("td", word(each.passed === false ? "failed" : "passed"), each.passed === false ? "failed" : "passed")]);
    return [table([word("target"), word("points"), `${word("error")} (µm)`, word("judgement")], rows), links(data.contents, "tables/")];
  });
  panel.replaceChildren(select, button(word("write"), write), place);
}
