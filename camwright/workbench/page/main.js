// The page: wires form, plots and views to the state.

import { get, post } from "./api.js";
import { button, make } from "./elements.js";
import * as form from "./form.js";
import { onGrip } from "./handles.js";
import * as head from "./head.js";
import { chosen, follow, slaveUnits } from "./numbers.js";
import * as plots from "./plots.js";
import { committed, drafted, redraw } from "./proof.js";
import * as readings from "./readings.js";
import * as sliders from "./sliders.js";
import { begin, changed, commit, onChange, state, step } from "./state.js";
import { plain, values } from "./toml.js";
import { callOff, outdated } from "./views/asking.js";
import { FOLLOWING, VIEWS } from "./views/index.js";
import { speak, word } from "./words.js";

const $ = (id) => document.getElementById(id);
let place = null;
let view = "checks";

function render() {
  head.badge($("badge"));
  head.refusal($("refusal"));
  form.showFaults($("form"), state.refusal?.faults ?? []);
  $("job-name").textContent = plain(values(state.text).name);
  $("undo").disabled = state.at === 0;
  $("redo").disabled = state.at === state.history.length - 1;
  if (state.drawn === null) return;
  if (follow(state.drawn)) $("master").value = chosen.master;
  const focused = document.activeElement?.closest("#plots [data-path]")?.dataset.path;
  place = plots.draw($("plots"), state.drawn, onGrip);
  if (focused) document.querySelector(`#plots [data-path="${focused}"]`)?.focus();
  readings.show($("readings"), place, state.drawn);
  legend();
  units();
  $("panel").classList.toggle("earlier", FOLLOWING.has(view) && state.proof === null && state.status !== "faulty" && state.status !== "infeasible");
  $("outdated").hidden = FOLLOWING.has(view) || !outdated($("panel"));
}

/** What the lines are; those that may go have a button. */
function legend() {
  const entry = ({ kind, name }) => {
    const made = make("span", undefined, "entry");
    made.append(make("i", undefined, `line ${kind}`), name);
    if (kind.startsWith("overlay")) made.append(Object.assign(button("×", () => { state.overlay = null; render(); }), { ariaLabel: `${word("remove")} ${name}` }));
    return made;
  };
  $("legend").replaceChildren(...[{ kind: "", name: word("optimised") }, ...plots.curvesBeside(state.drawn)].map(entry));
}

function units() {
  const options = slaveUnits(state.drawn);
  const select = $("slave-unit");
  if ([...select.options].map((each) => each.value).join() === options.join()) return;
  select.replaceChildren(...options.map((each) => Object.assign(make("option", each === "deg" ? "°" : each), { value: each })));
  if (!options.includes(chosen.slave)) [chosen.slave] = options;
  select.value = chosen.slave;
}

function compared() {
  $("laws").replaceChildren(...state.known.laws.map((law) => {
    const label = make("label");
    const box = Object.assign(make("input"), { type: "checkbox", checked: state.laws.includes(law) });
    box.addEventListener("change", () => {
      state.laws = state.known.laws.filter((each) => (each === law ? box.checked : state.laws.includes(each)));
      redraw();
    });
    label.append(box, ` ${word(law)}`);
    return label;
  }));
}

function tabs() {
  $("tabs").replaceChildren(...Object.keys(VIEWS).map((name) => {
    const tab = button(word(name), () => open(name));
    tab.id = `tab-${name}`;
    tab.dataset.view = name;
    for (const [attribute, value] of [["role", "tab"], ["aria-selected", String(name === view)], ["aria-controls", "panel"]]) tab.setAttribute(attribute, value);
    tab.tabIndex = name === view ? 0 : -1;
    return tab;
  }));
}

function open(name) {
  view = name;
  tabs();
  $("panel").setAttribute("aria-labelledby", `tab-${name}`);
  $("outdated").hidden = true;
  callOff();
  $("panel").replaceChildren();
  delete $("panel").dataset.text;
  VIEWS[name]($("panel"));
}

/** Between tabs by arrow keys, as everywhere. */
function tabKeys(event) {
  const names = Object.keys(VIEWS);
  const to = { ArrowRight: names.indexOf(view) + 1, ArrowLeft: names.indexOf(view) - 1, Home: 0, End: names.length - 1 }[event.key];
  if (to === undefined) return;
  event.preventDefault();
  open(names[(to + names.length) % names.length]);
  $(`tab-${view}`).focus();
}

onChange((what) => {
  if (what === "drawn" || what === "status") render();
  else if (what === "proof" && FOLLOWING.has(view)) VIEWS[view]($("panel"));
  if (!["draft", "commit", "release"].includes(what)) return;
  if (FOLLOWING.has(view)) callOff(); // it is asked anew for the next design
  form.refresh($("form"));
  sliders.refresh($("sliders"));
  if ($("toml") !== document.activeElement) $("toml").value = state.text;
  (what === "draft" ? drafted : committed)(what);
});

async function save() {
  const { ok, data } = await post("save", { toml: state.text });
  $("said").textContent = ok ? `${word("saved")}: ${data.files.join(", ")}` : data.message;
}

function pin() {
  state.pinned = state.pinned ? null : state.drawn;
  $("pin").setAttribute("aria-pressed", String(state.pinned !== null));
  render();
}

/** Keys of the page: those of every editor, and a letter for what has none. */
function keys(event) {
  const typing = ["INPUT", "TEXTAREA", "SELECT"].includes(document.activeElement.tagName) && document.activeElement.type !== "range";
  const control = event.ctrlKey || event.metaKey;
  const act = {
    z: () => !typing && step(event.shiftKey ? 1 : -1),
    y: () => !typing && step(1),
    s: save,
  }[control ? event.key.toLowerCase() : ""] ?? (!control && !typing && !event.altKey ? { p: pin, "?": () => $("help").showModal() }[event.key] : undefined);
  if (!act || (control && typing && event.key.toLowerCase() !== "s")) return;
  event.preventDefault();
  act();
}

async function translate(language) {
  await speak(language);
  build();
}

function build() {
  sliders.build($("sliders"));
  sliders.refresh($("sliders"));
  form.build($("form"));
  compared();
  open(view);
  render();
}

function wire() {
  $("undo").addEventListener("click", () => step(-1));
  $("redo").addEventListener("click", () => step(1));
  $("pin").addEventListener("click", pin);
  $("save").addEventListener("click", save);
  $("keys").addEventListener("click", () => $("help").showModal());
  $("close").addEventListener("click", () => $("help").close());
  $("master").addEventListener("change", (event) => { chosen.master = event.target.value; render(); });
  $("slave-unit").addEventListener("change", (event) => { chosen.slave = event.target.value; render(); });
  $("look").addEventListener("change", (event) => { document.documentElement.dataset.look = event.target.value; });
  $("language").addEventListener("change", (event) => translate(event.target.value));
  $("toml").addEventListener("change", () => commit($("toml").value));
  $("form").addEventListener("submit", (event) => event.preventDefault());
  $("tabs").addEventListener("keydown", tabKeys);
  $("plots").addEventListener("pointermove", (event) => place && event.buttons === 0 && readings.point($("readings"), place, state.drawn, event.clientX));
  $("plots").addEventListener("pointerdown", (event) => place && readings.point($("readings"), place, state.drawn, event.clientX));
  $("plots").addEventListener("keydown", (event) => {
    if (event.target === $("plots") && place && readings.key($("readings"), place, state.drawn, event)) event.preventDefault();
  });
  addEventListener("keydown", keys);
  addEventListener("beforeprint", () => { $("printed").textContent = state.text; });
  addEventListener("resize", () => state.drawn && render());
}

async function start() {
  const languages = [...$("language").options].map((each) => each.value);
  $("language").value = languages.find((each) => navigator.language.startsWith(each)) ?? "en";
  const [{ data }] = await Promise.all([get("api/job"), speak($("language").value)]);
  Object.assign(state, { keys: data.keys, targets: data.targets, known: { laws: data.laws } });
  begin(data.toml);
  committed("commit"); // on its way while the form is built
  $("toml").value = state.text;
  build();
  wire();
}

start();
