// Numbers and units as they are printed, and the units that the user chose for master and slave.

import { word } from "./words.js";

const RAISED = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };
const raised = (text) => [...String(text)].map((sign) => RAISED[sign]).join("");

/** A number of five digits with a true minus and the decimal sign of the language; very small and very large ones as a power of ten. */
export function digits(value, count = 5) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const print = (text) => text.replace("-", "−").replace(".", word("decimal"));
  if (size > 0 && (size < 1e-4 || size >= 1e7)) {
    const [mantissa, exponent] = value.toExponential(1).split("e");
    return `${print(mantissa)}·10${raised(Number(exponent))}`;
  }
  return print(Number(value.toPrecision(count)).toString());
}

/** A unit as it is printed: "rad/s^2" is rad/s², "N m" is N·m; 1 is no unit. */
export function printed(unit) {
  if (!unit || unit === "1") return "";
  return unit.replace(/\^(-?[0-9]+)/g, (_, power) => raised(power)).replace(/([A-Za-z²³]) (?=[A-Za-z])/g, "$1·").replace(/\bdeg\b/, "°");
}

export const withUnit = (value, unit) => [digits(value), printed(unit)].filter(Boolean).join(" ");

/** The job file's words for a quantity ("30 m/s^2") as they are printed. */
export const printedQuantity = ({ number, unit }) => withUnit(number, unit);

export const chosen = { master: "mm", slave: "m", inch: false };

/** Follow the units that a job is written in; true where they are others than before. */
export function follow(shown) {
  const inch = shown.units === "inch";
  if (inch === chosen.inch) return false;
  Object.assign(chosen, { inch, master: inch ? "in" : "mm", slave: inch ? "in" : "m" });
  return true;
}

/** Units of length of one metre. */
export const METRES = { m: 1, in: 1 / 0.0254 };
const FOOT = 0.3048; // m

/** Units that the slave of a job can be shown in: what it is counted in, inches, and degrees of whatever turns. */
export function slaveUnits(shown) {
  if (shown.slave_unit === "rad") return ["rad", "deg"];
  return shown.turn ? ["m", "in", "deg"] : ["m", "in"];
}

/** Factor from the slave's own unit to the chosen one, and that unit's names: over time, and of a small travel. */
export function slaveUnit(shown) {
  const unit = slaveUnits(shown).includes(chosen.slave) ? chosen.slave : slaveUnits(shown)[0];
  if (unit === "deg") {
    const factor = shown.slave_unit === "rad" ? 180 / Math.PI : 360 / shown.turn;
    return { factor, name: "°", small: { factor, name: "°" } };
  }
  if (unit === "rad") return { factor: 1, name: "rad", small: { factor: 180 / Math.PI, name: "°" } };
  return { factor: METRES[unit], name: unit, small: unit === "m" ? { factor: 1e3, name: "mm" } : { factor: METRES.in, name: "in" } };
}

/** Whether lengths are told in inches: as the master is shown, and where it is none as the job is written. */
const inInches = () => chosen.master === "in" || (chosen.master !== "mm" && chosen.inch);

/** Lengths along the material and speeds of the line, of one metre and one metre a second. */
export const lengthUnit = () => (inInches() ? { factor: METRES.in, name: "in" } : { factor: 1e3, name: "mm" });
export const speedUnit = () => (inInches() ? { factor: 60 / FOOT, name: "ft/min" } : { factor: 60, name: "m/min" });

/** A value in SI units as people read it: lengths in mm or inches, motion of an inch job in feet, angles in degrees. */
export function shownSi(value, unit) {
  if (value === null || value === undefined) return { value: null, unit: "" };
  if (unit === "m") return { value: value * lengthUnit().factor, unit: lengthUnit().name };
  if (unit === "rad") return { value: (value * 180) / Math.PI, unit: "°" };
  if (unit === "m/s" && chosen.inch) return { value: value * speedUnit().factor, unit: speedUnit().name };
  if (/^m\/s\^[23]$/.test(unit) && chosen.inch) return { value: value / FOOT, unit: printed(unit.replace("m", "ft")) };
  return { value, unit: printed(unit) };
}

/** A value in SI units with its unit, as a text. */
export function toldSi(value, unit) {
  const shown = shownSi(value, unit);
  return [digits(shown.value), shown.unit].filter(Boolean).join(" ");
}
