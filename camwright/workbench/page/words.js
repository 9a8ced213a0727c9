// The words of the page, one file a language with the same keys.

let words = {};

export async function speak(language) {
  const answer = await fetch(`page/words/${language}.json`);
  words = await answer.json();
  document.documentElement.lang = language;
  for (const element of document.querySelectorAll("[data-word]")) element.textContent = word(element.dataset.word);
}

export const word = (key) => words[key] ?? key;
