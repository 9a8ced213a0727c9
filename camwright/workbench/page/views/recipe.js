// The recipe: its sheet as it is printed, in the reader's language.

import { blobOf } from "../api.js";
import { button, chooser, make } from "../elements.js";
import { state } from "../state.js";
import { checkName, word } from "../words.js";
import { ask } from "./asking.js";
import { links } from "./files.js";

/** Whether the recipe is released, and which checks failed. */
function judged({ released, failed_checks: failed }) {
  const kind = released ? "passed" : "failed";
  return make("p", [word(kind), failed.map((name) => checkName(name)).join(", ")].filter(Boolean).join(": "), kind);
}

const LANGUAGES = [["en", "English"], ["de", "Deutsch"], ["zh", "中文"]];

export function show(panel) {
  const language = chooser(LANGUAGES, word("language"), document.documentElement.lang);
  const target = chooser(state.targets, word("target"), "csv");
  const place = make("div");
  const write = () => ask(place, "recipe", { toml: state.text, targets: [target.value], language: language.value }, (data) => {
    const page = Object.keys(data.contents).find((path) => path.endsWith("recipe.pdf"));
    const frame = Object.assign(make("iframe"), { title: word("recipe"), src: URL.createObjectURL(blobOf(data.contents[page], "application/pdf")) });
    return [judged(data), links(data.contents, "recipe/"), frame];
  });
  panel.replaceChildren(language, target, button(word("write"), write), place);
}
