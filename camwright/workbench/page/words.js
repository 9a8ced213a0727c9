// The words of the page: its own, and those of the recipes where both name the same thing.

import { get } from "./api.js";

let words = {};

export async function speak(language) {
  const { ok, data } = await get(`api/words?language=${language}`);
  if (!ok) return;
  words = data;
  document.documentElement.lang = language;
  for (const element of document.querySelectorAll("[data-word]")) element.textContent = word(element.dataset.word);
  for (const element of document.querySelectorAll("[data-label]")) element.setAttribute("aria-label", word(element.dataset.label));
}

/** A word by its key; what has none is a name of the program, shown as one. */
export const word = (key) => words[key] ?? words[`word.${key}`] ?? key.replaceAll("_", " ");

export const checkName = (name) => words[`check.${name}`] ?? word(name);
export const bindingName = (name) => words[`binding.${name}`] ?? checkName(name);
