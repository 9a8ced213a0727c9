// The job as a form made from the list of keys: values stand as they are typed, faults at their field.

import { make } from "./elements.js";
import { commit, set, state } from "./state.js";
import { plain, values, withValue } from "./toml.js";
import { word } from "./words.js";

const OPEN = new Set(["", "machine", "cut", "limits"]); // tables that stand open: the others are looked at less

const NARROW = 700; // px up to which all tables are closed: the views stand below them

const kindOf = (known) => plain(known["machine.kind"]);
const ofMachine = (kind) => state.keys.filter((key) => key.machine === "" || key.machine === kind);

/** Build the form for the machine that the job names. */
export function build(form) {
  const known = values(state.text);
  const kind = kindOf(known);
  form.dataset.kind = kind;
  form.replaceChildren();
  for (const [table, keys] of Map.groupBy(ofMachine(kind), (key) => key.table)) {
    const box = make("details");
    box.open = OPEN.has(table) && innerWidth > NARROW;
    box.append(make("summary", table ? word(`table.${table}`) : word("job")), ...keys.map((key) => field(key, known[key.path])));
    form.append(box);
  }
}

function field(key, value) {
  const box = make("div", undefined, "field");
  box.dataset.path = key.path;
  const label = make("label", word(`field.${key.path}`));
  const input = choices(key) ? choice(key) : make("input");
  input.id = `field-${key.path}`;
  label.htmlFor = input.id;
  box.title = about(key);
  box.addEventListener("focusin", () => { document.getElementById("about").textContent = about(key); });
  if (!choices(key)) input.placeholder = key.default ? plain(key.default) : `${word("optional")}: ${plain(key.example)}`;
  put(input, plain(value));
  input.addEventListener("change", () => (key.path === "machine.kind" ? setMachine(input.value) : set(key.path, typed(key, input.value.trim()))));
  box.append(label, input);
  return box;
}

/** Put a value into a field; a choice that has no such word, as its default is one with none, shows its default. */
function put(input, value) {
  input.value = value;
  if (input.tagName === "SELECT" && input.selectedIndex < 0) input.value = "";
}

/** What a key means, by its place in the job file, and what may stand there. */
const about = (key) => `${key.path}: ${word(`meaning.${key.path}`)}. ${document.documentElement.lang === "en" ? key.takes : `${word("for example")} ${plain(key.example)}`}`;

/** The words that a key takes, where it takes no others. */
function choices(key) {
  if (key.path === "machine.kind") return [...new Set(state.keys.filter((each) => each.path === key.path).map((each) => plain(each.takes)))];
  if (key.takes === "true or false") return ["true", "false"];
  return /^"[^"]+"( or "[^"]+")*$/.test(key.takes) ? key.takes.split(" or ").map(plain) : null;
}

function choice(key) {
  const select = make("select");
  if (!key.required) select.append(Object.assign(make("option", key.default ? `${name(plain(key.default))} (${word("default")})` : "–"), { value: "" }));
  for (const each of choices(key)) if (key.required || each !== plain(key.default)) select.append(Object.assign(make("option", name(each)), { value: each }));
  return select;
}

const name = (value) => ({ true: word("yes"), false: word("no") })[value] ?? word(value);

/** What was typed as it stands in the file: texts and quantities in quotes, numbers, lists and what has quotes as they are. */
function typed(key, text) {
  if (text === "" || /^["'[{]/.test(text)) return text;
  return key.example.startsWith('"') || choices(key)?.every((each) => !["true", "false"].includes(each)) ? JSON.stringify(text) : text;
}

/** Another machine: the keys of the old one go, those that the new one needs come with the values of an example. */
function setMachine(kind) {
  const known = values(state.text);
  let text = state.text;
  const wanted = ofMachine(kind).filter((key) => key.table === "machine");
  for (const path of Object.keys(known)) if (path.startsWith("machine.") && !wanted.some((key) => key.path === path)) text = withValue(text, path, "");
  for (const key of wanted) if (key.required && known[key.path] === undefined) text = withValue(text, key.path, key.example);
  commit(withValue(text, "machine.kind", JSON.stringify(kind)));
}

/** Bring the values of the text into the form. */
export function refresh(form) {
  const known = values(state.text);
  if (form.dataset.kind !== kindOf(known)) build(form);
  for (const box of form.querySelectorAll(".field")) {
    const input = box.querySelector("input, select");
    const value = known[box.dataset.path] ?? "";
    if (input !== document.activeElement || input.tagName === "SELECT") put(input, plain(value));
  }
}

/** Show the faults at their fields; what is about no field is left to the refusal. */
export function showFaults(form, faults) {
  for (const box of form.querySelectorAll(".field")) {
    const input = box.querySelector("input, select");
    input.removeAttribute("aria-invalid");
    input.removeAttribute("aria-describedby");
    box.querySelector(".fault")?.remove();
    const found = faults.find((fault) => fault.field === box.dataset.path);
    if (!found) continue;
    const told = Object.assign(make("p", found.message, "fault"), { id: `fault-${found.field}` });
    input.setAttribute("aria-invalid", "true");
    input.setAttribute("aria-describedby", told.id);
    box.append(told);
    box.closest("details").open = true;
  }
}
