// The job file's text is the truth: values are read from its lines and written into them, comments and order stay.

const LINE = /^(\s*)([A-Za-z0-9_]+)(\s*=\s*)("(?:[^"\\]|\\.)*"|'[^']*'|[^#]*?)(\s*(?:#.*)?)$/;

function* places(lines) {
  let table = "";
  for (let number = 0; number < lines.length; number += 1) {
    const heading = lines[number].match(/^\s*\[([^\]]+)\]/);
    if (heading) table = heading[1].trim();
    const found = heading ? null : lines[number].match(LINE);
    if (found) yield { number, path: table ? `${table}.${found[2]}` : found[2], found };
  }
}

/** Values by their places, as they stand in the text: {"cut.length": "\"600 mm\""}. */
export function values(text) {
  const known = {};
  for (const { path, found } of places(text.split("\n"))) known[path] = found[4].trim();
  return known;
}

/** The text with one value set; a key that is not there is added to its table, an empty value takes it out. */
export function withValue(text, path, value) {
  const lines = text.split("\n");
  for (const place of places(lines)) {
    if (place.path !== path) continue;
    const [, indent, key, sign, , rest] = place.found;
    if (value === "") lines.splice(place.number, 1);
    else lines[place.number] = `${indent}${key}${sign}${value}${rest}`;
    return lines.join("\n");
  }
  if (value === "") return text;
  const cut = path.lastIndexOf(".");
  const table = path.slice(0, cut);
  const line = `${path.slice(cut + 1)} = ${value}`;
  const at = lines.findIndex((each) => each.trim().startsWith(`[${table}]`));
  if (at < 0) return `${text.replace(/\n*$/, "")}\n\n[${table}]\n${line}\n`;
  lines.splice(at + 1, 0, line);
  return lines.join("\n");
}

/** A quantity as number and unit, or null: "\"600 mm\"" gives {number: 600, unit: "mm"}. */
export function quantity(value) {
  const found = (value ?? "").match(/^["']\s*([+-]?[0-9.]+(?:[eE][+-]?[0-9]+)?)\s*(.*?)\s*["']$/);
  return found && Number.isFinite(Number(found[1])) ? { number: Number(found[1]), unit: found[2] } : null;
}
