// The machine moving in time: drum, carriage or crank over running material, as the cam at hand moves it.

import { button, make, svg } from "../elements.js";
import { state } from "../state.js";
import { plain, quantity, values } from "../toml.js";
import { word } from "../words.js";

let running = 0; // the frame that is asked for
let pace = 0.25; // of the true one

/** Show the machine, standing; a button lets it run. */
export function show(panel) {
  cancelAnimationFrame(running);
  const drawing = svg("svg", { viewBox: "0 0 400 240", role: "img", "aria-label": word("machine") });
  const material = svg("rect", { class: "material", x: 0, y: 180, width: 400, height: 12 });
  const [marks, part] = [svg("g"), svg("g")];
  drawing.append(material, marks, part);
  let on = false;
  const run = button(word("run"), () => {
    on = !on;
    run.textContent = word(on ? "stop" : "run");
    cancelAnimationFrame(running);
    if (on) animate(drawing, part, marks);
  });
  const slider = Object.assign(make("input"), { type: "range", min: -2, max: 2, step: 0.25, value: Math.log10(pace) });
  const label = make("label", `${word("pace")} `);
  slider.addEventListener("input", () => { pace = 10 ** slider.value; });
  label.append(slider);
  panel.replaceChildren(run, label, drawing);
  frame(part, marks, 0);
}

function animate(drawing, part, marks) {
  let [seconds, before] = [0, performance.now()];
  const turn = (now) => {
    seconds += ((now - before) / 1000) * pace;
    before = now;
    frame(part, marks, seconds);
    if (drawing.isConnected) running = requestAnimationFrame(turn);
  };
  running = requestAnimationFrame(turn);
}

/** Where everything stands at a time: cuts on the material, and the tool. */
function frame(part, marks, seconds) {
  const shown = state.drawn;
  if (!shown) return;
  const { x_m: x, y } = shown.samples;
  const length = x[x.length - 1] - x[0];
  const sample = (metres) => Math.min(x.length - 1, Math.max(0, Math.round((metres / length) * (x.length - 1))));
  const at = (seconds * shown.line_speed_m_per_s) % length;
  const [zone] = shown.zones_m.sync;
  const middle = (zone[0] + zone[1]) / 2 - x[0];
  const scale = 260 / length;
  marks.replaceChildren(...[-1, 0, 1, 2].map((cut) => {
    const place = 200 + (at - middle + cut * length) * scale;
    return svg("line", { class: "blade", x1: place, x2: place, y1: 178, y2: 194 });
  }));
  part.replaceChildren(...tool(shown, y[sample(at)] - y[sample(middle)], scale));
}

function tool(shown, travel, scale) {
  const known = values(state.text);
  const kind = plain(known["machine.kind"]);
  if (kind === "rotary_knife") return drum(Number(known["machine.blades"] ?? 1), (2 * Math.PI * travel) / shown.turn);
  if (kind === "crank_slider") return crank(quantity(known["machine.crank"]), quantity(known["machine.rod"]), travel);
  const x = 200 + travel * scale;
  return [svg("rect", { class: "drum", x: x - 30, y: 120, width: 60, height: 30 }), svg("line", { class: "blade", x1: x, y1: 150, x2: x, y2: 178 })];
}

function drum(blades, angle) {
  const hands = Array.from({ length: blades }, (_, k) => angle + (2 * Math.PI * k) / blades + Math.PI / 2);
  return [
    svg("circle", { class: "drum", cx: 200, cy: 100, r: 66 }),
    ...hands.map((each) => svg("line", { class: "blade", x1: 200 - 40 * Math.cos(each), y1: 100 + 40 * Math.sin(each), x2: 200 - 80 * Math.cos(each), y2: 100 + 80 * Math.sin(each) })),
  ];
}

function crank(arm, rod, travel) {
  const ratio = arm && rod && arm.unit === rod.unit ? rod.number / arm.number : 4;
  const angle = travel + Math.PI / 2;
  const [px, py] = [110 - 40 * Math.cos(angle), 100 - 40 * Math.sin(angle)];
  const shift = 200 - (110 + Math.sqrt((40 * ratio) ** 2 - 1600));
  const x = px + Math.sqrt(Math.max((40 * ratio) ** 2 - (py - 100) ** 2, 0)) + shift;
  return [
    svg("circle", { class: "drum", cx: 110 + shift, cy: 100, r: 40 }),
    svg("line", { class: "drum", x1: px + shift, y1: py, x2: x, y2: 100 }),
    svg("rect", { class: "drum", x: x - 22, y: 86, width: 44, height: 28 }),
    svg("line", { class: "blade", x1: x, y1: 114, x2: x, y2: 178 }),
  ];
}
