// The page: wires form, plots and views to the state; previews while a hand moves, proof when it rests.

import { get, newestOnly, post } from "./api.js";
import { build, buildSliders, refresh, showFaults } from "./form.js";
import * as plots from "./plots.js";
import { begin, changed, commit, draft, onChange, set, state, step } from "./state.js";
import { quantity, values, withValue } from "./toml.js";
import { VIEWS } from "./views.js";
import { speak, word } from "./words.js";

const LAWS = ["linear_return", "poly_3_4_5"];
const PLACE = { line_speed: "cut.line_speed", length: "cut.length", sync_zone: "cut.sync_zone", stroke: "machine.stroke" };
const $ = (id) => document.getElementById(id);
let place = null;
let view = "checks";

const previewed = newestOnly(async (text) => {
  const { ok, data } = await post("preview", { toml: text, laws: LAWS });
  state.refusal = ok ? null : data;
  if (ok) {
    state.drawn = data;
    if (state.status !== "proved" && state.status !== "failed") state.status = "preview";
  } else state.status = data.status === "infeasible" ? "infeasible" : "faulty";
  render();
});

let asked = 0;

async function prove() {
  const mine = (asked += 1);
  state.status = "proving";
  badge();
  const { ok, data } = await post("design", { toml: state.text });
  if (mine !== asked || data.status === "stale") return;
  state.proof = ok ? data : null;
  state.refusal = ok ? null : data;
  state.status = ok ? (data.passed ? "proved" : "failed") : data.status === "infeasible" ? "infeasible" : "faulty";
  render();
  if (view === "checks") VIEWS.checks($("panel"));
}

function badge() {
  const shown = $("badge");
  shown.className = { proved: "proved", failed: "failed", infeasible: "failed", faulty: "failed" }[state.status] ?? "";
  const { proof, drawn } = state;
  const objective = state.status === "proved" || state.status === "failed" ? proof?.objective : drawn?.objective;
  const value = objective && state.status !== "faulty" && state.status !== "infeasible" ? ` ${objective.name} ${plots.digits(objective.value)} ${objective.unit}` : "";
  const failed = state.status === "failed" ? `: ${proof.checks.filter((check) => !check.passed).map((check) => check.name).join(", ")}` : "";
  const stand = state.status === "preview" && drawn && !drawn.exact ? ` (${word("stands in")})` : "";
  shown.textContent = `${word(state.status)}${failed}${value}${stand}`;
}

function refusal() {
  const box = $("refusal");
  const data = state.refusal;
  box.hidden = data === null;
  if (data === null) return;
  const told = document.createElement("p");
  told.textContent = data.message;
  box.replaceChildren(told);
  if (data.suggestions?.length) box.append(word("what works"), " ");
  for (const each of data.suggestions ?? []) {
    const path = PLACE[each.change] ?? `limits.${each.change}`;
    const value = each.change === "reversal" ? "true" : JSON.stringify(`${each.value} ${each.unit}`);
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: `${path} = ${value}` });
    button.addEventListener("click", () => set(path, value));
    box.append(button);
  }
}

function render() {
  badge();
  refusal();
  showFaults($("form"), state.refusal?.faults ?? []);
  $("job-name").textContent = values(state.text).name?.replaceAll('"', "") ?? "";
  $("undo").disabled = state.at === 0;
  $("redo").disabled = state.at === state.history.length - 1;
  if (state.drawn) {
    place = plots.draw($("plots"), state.drawn, { onGrip });
    const binding = state.drawn.binding.map(word).join(", ");
    $("legend").textContent = `${binding ? `${word("binds")}: ${binding}` : word("nothing binds")} — ${word("optimised")}, ${LAWS.map(word).join(", ")}${state.ghost ? `, ${word("previous")}` : ""}${state.pinned ? `, ${word("pinned")}` : ""}`;
  }
}

/** Drag a limit or a zone's end; arrow keys do the same by one in a hundred. */
function onGrip(element, grip) {
  const change = (base, way, text) => {
    const found = quantity(base);
    if (!found) return text;
    const number = Number(Math.max(found.number * way, Number.MIN_VALUE).toPrecision(4));
    return withValue(text, grip.path, JSON.stringify(`${number} ${found.unit}`));
  };
  element.addEventListener("keydown", (event) => {
    const way = { ArrowRight: 1.01, ArrowUp: 1.01, ArrowLeft: 0.99, ArrowDown: 0.99 }[event.key];
    if (!way) return;
    event.preventDefault();
    commit(change(values(state.text)[grip.path], way, state.text));
    document.querySelector(`[data-path="${grip.path}"]`)?.focus();
  });
  element.addEventListener("pointerdown", (event) => {
    event.preventDefault();
    const base = values(state.text)[grip.path];
    const length = place.end - place.start;
    const metres = grip.path === "cut.length" ? length : grip.path === "cut.sync_zone" ? state.drawn.zones_m.sync[0][1] - state.drawn.zones_m.sync[0][0] : grip.value;
    const perPixel = grip.vertical ? grip.perPixel : place.metresPerPixel() * (grip.path === "cut.sync_zone" ? -1 : 1);
    const [x, y] = [event.clientX, event.clientY];
    const move = (now) => draft(change(base, 1 + ((grip.vertical ? y - now.clientY : now.clientX - x) * perPixel) / metres, state.text));
    const end = () => {
      removeEventListener("pointermove", move);
      removeEventListener("pointerup", end);
      commit();
    };
    addEventListener("pointermove", move);
    addEventListener("pointerup", end);
  });
}

function tabs() {
  $("tabs").replaceChildren(...Object.keys(VIEWS).map((name) => {
    const tab = Object.assign(document.createElement("button"), { type: "button", textContent: word(name) });
    tab.setAttribute("role", "tab");
    tab.setAttribute("aria-selected", String(name === view));
    tab.dataset.view = name;
    tab.addEventListener("click", () => {
      view = name;
      tabs();
      VIEWS[name]($("panel"));
    });
    return tab;
  }));
}

onChange((what) => {
  refresh($("form"), $("sliders"));
  if ($("toml") !== document.activeElement) $("toml").value = state.text;
  if (what === "draft") state.status = "preview";
  previewed(state.text);
  if (what === "commit") prove();
});

async function start() {
  const { data } = await get("api/job");
  Object.assign(state, { keys: data.keys, targets: data.targets });
  begin(data.toml);
  await speak("en");
  build($("form"));
  $("form").dataset.kind = values(state.text)["machine.kind"];
  buildSliders($("sliders"));
  tabs();
  $("undo").addEventListener("click", () => step(-1));
  $("redo").addEventListener("click", () => step(1));
  $("pin").addEventListener("click", () => {
    state.pinned = state.pinned ? null : state.drawn;
    $("pin").setAttribute("aria-pressed", String(state.pinned !== null));
    render();
  });
  $("save").addEventListener("click", async () => {
    const { ok, data: said } = await post("save", { toml: state.text });
    $("readout").textContent = ok ? `${word("saved")}: ${said.files.join(", ")}` : said.message;
  });
  $("master").addEventListener("change", (event) => {
    plots.master.unit = event.target.value;
    render();
  });
  $("language").addEventListener("change", async (event) => {
    await speak(event.target.value);
    buildSliders($("sliders"));
    tabs();
    changed("words");
    VIEWS[view]($("panel"));
  });
  $("toml").addEventListener("change", () => commit($("toml").value));
  $("form").addEventListener("submit", (event) => event.preventDefault());
  $("plots").addEventListener("pointermove", (event) => {
    if (place && event.buttons === 0) $("readout").textContent = plots.read($("plots"), place, state.drawn, event.clientX);
  });
  addEventListener("keydown", (event) => {
    if ((event.ctrlKey || event.metaKey) && event.key === "z" && !["INPUT", "TEXTAREA"].includes(document.activeElement.tagName)) {
      event.preventDefault();
      step(event.shiftKey ? 1 : -1);
    }
  });
  changed("commit");
}

addEventListener("resize", () => state.drawn && render());

start();
