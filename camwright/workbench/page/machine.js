// The machine moving in time: drum, carriage or crank over running material, as the cam at hand moves it.

import { state } from "./state.js";
import { lineSpeed } from "./plots.js";
import { quantity, values } from "./toml.js";
import { word } from "./words.js";

const NS = "http://www.w3.org/2000/svg";
let running = 0;

const element = (name, attributes) => {
  const made = document.createElementNS(NS, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
};

/** Show the machine; a quarter of its true pace. */
export function show(panel) {
  cancelAnimationFrame(running);
  const svg = element("svg", { viewBox: "0 0 400 240", role: "img", "aria-label": word("machine") });
  const material = element("rect", { class: "material", x: 0, y: 180, width: 400, height: 12 });
  const marks = element("g", {});
  const part = element("g", {});
  svg.append(material, marks, part);
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = word("run");
  button.addEventListener("click", () => {
    const on = button.textContent === word("run");
    button.textContent = word(on ? "stop" : "run");
    cancelAnimationFrame(running);
    if (on) animate(part, marks);
  });
  panel.replaceChildren(button, svg);
  frame(part, marks, 0);
}

function animate(part, marks) {
  const begun = performance.now();
  const turn = (now) => {
    frame(part, marks, (now - begun) / 4000);
    running = requestAnimationFrame(turn);
  };
  running = requestAnimationFrame(turn);
}

function frame(part, marks, seconds) {
  const shown = state.drawn;
  if (!shown) return;
  const { x_m: x, y } = shown.samples;
  const length = x[x.length - 1] - x[0];
  const at = (seconds * lineSpeed(shown)) % length;
  const i = Math.min(x.length - 1, Math.round((at / length) * (x.length - 1)));
  const zone = shown.zones_m.sync[0];
  const middle = Math.round((((zone[0] + zone[1]) / 2 - x[0]) / length) * (x.length - 1));
  const scale = 260 / length;
  marks.replaceChildren(...[-1, 0, 1, 2].map((cut) => element("line", { class: "blade", x1: 200 + (at - (zone[0] + zone[1]) / 2 + cut * length) * scale, x2: 200 + (at - (zone[0] + zone[1]) / 2 + cut * length) * scale, y1: 178, y2: 194 })));
  part.replaceChildren(...drawing(shown, y[i] - y[middle], scale));
}

function drawing(shown, travel, scale) {
  const known = values(state.text);
  const kind = JSON.parse(known["machine.kind"] ?? '""');
  if (kind === "rotary_knife") {
    const blades = Number(known["machine.blades"] ?? 1);
    const pitch = shown.samples.y[shown.samples.y.length - 1] - shown.samples.y[0];
    const hands = Array.from({ length: blades }, (_, k) => (2 * Math.PI * (travel / pitch + k)) / blades + Math.PI / 2);
    return [element("circle", { class: "drum", cx: 200, cy: 100, r: 66 }), ...hands.map((angle) => element("line", { class: "blade", x1: 200 - 40 * Math.cos(angle), y1: 100 + 40 * Math.sin(angle), x2: 200 - 80 * Math.cos(angle), y2: 100 + 80 * Math.sin(angle) }))];
  }
  if (shown.slave_unit === "m") {
    const x = 200 + travel * scale;
    return [element("rect", { class: "drum", x: x - 30, y: 120, width: 60, height: 30 }), element("line", { class: "blade", x1: x, y1: 150, x2: x, y2: 178 })];
  }
  const crank = quantity(known["machine.crank"]);
  const rod = quantity(known["machine.rod"]);
  const ratio = crank && rod ? rod.number / crank.number : 4;
  const angle = travel + Math.PI / 2;
  const [px, py] = [110 - 40 * Math.cos(angle), 100 - 40 * Math.sin(angle)];
  const x = px + Math.sqrt(Math.max((40 * ratio) ** 2 - (py - 100) ** 2, 0));
  const shift = 200 - (110 + Math.sqrt((40 * ratio) ** 2 - 1600));
  return [element("circle", { class: "drum", cx: 110 + shift, cy: 100, r: 40 }), element("line", { class: "drum", x1: px + shift, y1: py, x2: x + shift, y2: 100 }), element("rect", { class: "drum", x: x + shift - 22, y: 86, width: 44, height: 28 }), element("line", { class: "blade", x1: x + shift, y1: 114, x2: x + shift, y2: 178 })];
}
