// From values to places on the screen.

import { svg } from "./elements.js";
import { digits } from "./numbers.js";

/** Round values between two ends, some five of them. */
export function ticks(low, high, count = 4) {
  const raw = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 2.5, 5, 10].map((each) => each * power).find((each) => each >= raw);
  const found = [];
  for (let at = Math.ceil(low / step) * step; at <= high + step * 1e-9; at += step) found.push(Math.abs(at) < step / 1e6 ? 0 : at);
  return found;
}

/** A path through points; a gap where a value is none. */
export function path(x, y, across, down) {
  let text = "";
  let pen = "M";
  for (let i = 0; i < x.length; i += 1) {
    if (y[i] === null || y[i] === undefined) {
      pen = "M";
      continue;
    }
    text += `${pen}${across(x[i]).toFixed(1)} ${down(y[i]).toFixed(1)}`;
    pen = "L";
  }
  return text;
}

/** A plot of its own: frame, ticks and titles; gives the drawing, its two maps and their inverse (of a plot that is not logarithmic). */
export function plot({ width = 460, height = 240, x, y, xTitle, yTitle, logarithmic = false }) {
  const [left, right, top, bottom] = [56, 18, 22, 38];
  const drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, class: "plot" });
  const across = (value) => left + ((value - x[0]) / (x[1] - x[0])) * (width - left - right);
  const high = (value) => (logarithmic ? Math.log10(Math.max(value, y[0])) : value);
  const [low, most] = [high(y[0]), high(y[1])];
  const down = (value) => Math.min(Math.max(height - bottom - ((high(value) - low) / (most - low)) * (height - top - bottom), top), height - bottom);
  drawing.append(svg("rect", { class: "frame", x: left, y: top, width: width - left - right, height: height - top - bottom }));
  for (const tick of ticks(...x, 6)) drawing.append(svg("text", { class: "tick", x: across(tick), y: height - bottom + 14, "text-anchor": "middle" }, digits(tick)));
  const levels = logarithmic ? ticks(Math.ceil(low), Math.floor(most)).filter(Number.isInteger).map((power) => 10 ** power) : ticks(...y);
  for (const tick of levels) drawing.append(svg("text", { class: "tick", x: left - 5, y: down(tick) + 4, "text-anchor": "end" }, digits(tick)));
  drawing.append(svg("text", { class: "title", x: width - right, y: height - 6, "text-anchor": "end" }, xTitle), svg("text", { class: "title", x: 4, y: 13 }, yTitle));
  const shareOf = (at, from, to) => Math.min(Math.max((at - from) / (to - from), 0), 1);
  const inverse = (px, py) => [x[0] + (x[1] - x[0]) * shareOf(px, left, width - right), y[0] + (y[1] - y[0]) * shareOf(py, height - bottom, top)];
  return { drawing, across, down, inverse, left, right: width - right, top, bottom: height - bottom };
}
