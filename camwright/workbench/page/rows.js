// What the stacked plots show, from the samples that the server sends.

import { METRES, chosen, slaveUnit } from "./numbers.js";

/** What is left of the travel when an even one is taken out. */
function correction({ x_m: x, y }) {
  const last = x.length - 1;
  const even = (y[last] - y[0]) / (x[last] - x[0]);
  return y.map((each, i) => each - y[0] - even * (x[i] - x[0]));
}

const scaled = (name, factor) => (samples) => samples[name]?.map((value) => value * factor);

/** Plots from top to bottom: name, unit, values of some samples (nothing where these have none), and the limit's name. */
export function rowsOf(shown) {
  const { factor, name, small } = slaveUnit(shown);
  const list = [
    { name: "correction", unit: small.name, factor: small.factor, of: (samples) => correction(samples).map((value) => value * small.factor) },
    METRES[name] ? { name: "ratio", unit: "1", factor: 1, of: scaled("ratio", 1) } : { name: "ratio", unit: `${name}/m`, factor, of: scaled("ratio", factor) },
    { name: "speed", unit: `${name}/s`, factor, limit: "speed", of: scaled("speed", factor) },
    { name: "acceleration", unit: `${name}/s²`, factor, limit: "acceleration", of: scaled("acceleration", factor) },
    { name: "jerk", unit: `${name}/s³`, factor, limit: "jerk", of: scaled("jerk", factor) },
  ];
  if (shown.samples.torque) list.push({ name: "torque", unit: "N·m", factor: 1, of: scaled("torque", 1), within: "available_torque" });
  return list.map((row) => ({ ...row, of: kept(row.of) }));
}

/** Work a row out once for all that ask: scale, curve, extremes, cursor. */
function kept(of) {
  const known = new Map();
  return (samples) => {
    if (!known.has(samples)) known.set(samples, of(samples));
    return known.get(samples);
  };
}

/** What stands along the plots: a place on the master as length, angle or time, or the slave's own position. */
export function abscissa(shown) {
  const { x_m: x } = shown.samples;
  const length = x[x.length - 1] - x[0];
  if (chosen.master === "slave") {
    const { factor, small } = slaveUnit(shown);
    const by = small.name === "°" ? small.factor : factor;
    const unit = small.name === "°" ? "°" : slaveUnit(shown).name;
    return { name: "slave", unit, of: ({ y }) => y.map((value) => (value - y[0]) * by) };
  }
  const [factor, unit, name] = {
    mm: [1e3, "mm", "master"],
    in: [1 / 0.0254, "in", "master"],
    deg: [360 / length, "°", "master"],
    ms: [1e3 / shown.line_speed_m_per_s, "ms", "time"],
  }[chosen.master];
  return { name, unit, of: (samples) => samples.x_m.map((value) => ((value - samples.x_m[0]) / (samples.x_m[samples.x_m.length - 1] - samples.x_m[0])) * length * factor) };
}

/** Greatest and least value with their places, as numbers of samples; one of them where all have one sign. */
export function extremes(values) {
  let [low, high] = [0, 0];
  values.forEach((value, i) => {
    if (value > values[high]) high = i;
    if (value < values[low]) low = i;
  });
  const size = Math.max(Math.abs(values[low]), Math.abs(values[high]));
  return [high, low].filter((i, order) => (order === 0 ? values[i] > 0.02 * size || values[low] === values[high] : values[i] < -0.02 * size));
}

/** The value that is greatest in size. */
export const greatest = (values) => values.reduce((best, value) => (Math.abs(value) > Math.abs(best) ? value : best), 0);
