// Elements of the page and of its drawings. Texts are always set as texts: a job may be called by any name.

import { digits } from "./numbers.js";

export function make(name, text, kind) {
  const element = document.createElement(name);
  if (text !== undefined) element.textContent = text;
  if (kind) element.className = kind;
  return element;
}

export function svg(name, attributes = {}, text) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
}

export function button(text, press) {
  const made = Object.assign(make("button", text), { type: "button" });
  made.addEventListener("click", press);
  return made;
}

/** Let Enter and the space bar press an element of a drawing, as they press a button. */
export function onPress(element, press) {
  element.addEventListener("keydown", (event) => {
    if (!["Enter", " "].includes(event.key)) return;
    event.preventDefault();
    press();
  });
}

/** A choice: names as they are, or pairs of value and name. */
export function chooser(options, label, value) {
  const select = make("select");
  for (const option of options) {
    const [own, name] = Array.isArray(option) ? option : [option, option];
    select.append(Object.assign(make("option", name), { value: own }));
  }
  if (value !== undefined) select.value = value;
  select.setAttribute("aria-label", label);
  return select;
}

/** A table; numbers stand to the right, elements as they are. It scrolls by itself where it is too wide. */
export function table(headings, lines) {
  const made = make("table");
  const numeric = (column) => lines.some((line) => typeof line[column] === "number");
  const head = made.createTHead().insertRow();
  headings.forEach((heading, column) => {
    const cell = Object.assign(make("th", heading), { scope: "col" });
    if (numeric(column)) cell.className = "number";
    head.append(cell);
  });
  const body = made.createTBody();
  for (const line of lines) {
    const row = body.insertRow();
    line.forEach((cell, column) => {
      const text = typeof cell === "number" ? digits(cell) : (cell ?? "–");
      row.append(cell instanceof Node ? cell : make("td", text, numeric(column) ? "number" : ""));
    });
  }
  const box = make("div", undefined, "scroll");
  box.append(made);
  return box;
}

/** Mark a table's row; the table as `table` makes it. */
export const row = (box, number) => box.querySelector("tbody").rows[number];

export const waiting = () => make("p", "…", "waiting");

const MOST_BYTES = 6e6; // a call has at most 8 MiB, and base64 makes four letters of three bytes

/** Take a file by choosing or by dropping it; one that no call could bring is refused here. */
export function dropZone(text, tooLarge, accept, taken) {
  const box = make("label", text, "drop");
  const refused = make("p", "", "failed");
  box.append(refused);
  const take = (file) => {
    refused.textContent = file.size > MOST_BYTES ? tooLarge : "";
    if (file.size <= MOST_BYTES) taken(file);
  };
  const input = Object.assign(make("input"), { type: "file", accept });
  box.append(input);
  input.addEventListener("change", () => input.files[0] && take(input.files[0]));
  box.addEventListener("dragover", (event) => {
    event.preventDefault();
    box.classList.add("over");
  });
  box.addEventListener("dragleave", () => box.classList.remove("over"));
  box.addEventListener("drop", (event) => {
    event.preventDefault();
    box.classList.remove("over");
    if (event.dataTransfer.files[0]) take(event.dataTransfer.files[0]);
  });
  return box;
}
