// The job file's text is the truth: values are read from its lines and written into them, comments and order stay.

const LINE = /^(\s*)([A-Za-z0-9_]+)(\s*=\s*)("(?:[^"\\]|\\.)*"|'[^']*'|[^#]*?)(\s*(?:#.*)?)$/;

const depth = (text) => (text.match(/\[/g) ?? []).length - (text.match(/\]/g) ?? []).length;

/** Places of values: the line that one stands in, and how many more a list takes. */
function* places(lines) {
  let table = "";
  for (let number = 0; number < lines.length; number += 1) {
    const heading = lines[number].match(/^\s*\[([^[\]]+)\]\s*(#.*)?$/);
    if (heading) {
      table = heading[1].trim();
      continue;
    }
    const found = lines[number].match(LINE);
    if (!found) continue;
    let more = 0;
    if (found[4].startsWith("[")) {
      let open = depth(found[4]);
      while (open > 0 && number + more + 1 < lines.length) {
        more += 1;
        open += depth(lines[number + more]);
      }
    }
    yield { number, more, path: table ? `${table}.${found[2]}` : found[2], found };
    number += more;
  }
}

/** Values by their places, as they stand in the text: {"cut.length": "\"600 mm\""}. */
export function values(text) {
  const known = {};
  const lines = text.split("\n");
  for (const { path, number, more, found } of places(lines)) known[path] = [found[4].trim(), ...lines.slice(number + 1, number + 1 + more).map((line) => line.trim())].join(" ");
  return known;
}

/** The text with one value set; a key that is not there is added to its table, an empty value takes it out. */
export function withValue(text, path, value) {
  const lines = text.split("\n");
  for (const place of places(lines)) {
    if (place.path !== path) continue;
    const [, indent, key, sign, , rest] = place.found;
    lines.splice(place.number, place.more + 1, ...(value === "" ? [] : [`${indent}${key}${sign}${value}${rest}`]));
    return lines.join("\n");
  }
  if (value === "") return text;
  const cut = path.lastIndexOf(".");
  const [table, line] = [path.slice(0, Math.max(cut, 0)), `${path.slice(cut + 1)} = ${value}`];
  if (!table) return `${line}\n${text}`;
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

/** A quantity as it is written: four digits are what a hand can set. */
export const written = (number, unit) => JSON.stringify(`${Number(number.toPrecision(4))} ${unit}`);

/** A text value without its quotes; anything else as it stands. */
export function plain(value) {
  try {
    const read = JSON.parse(value);
    return typeof read === "string" ? read : value;
  } catch {
    return value?.match(/^'(.*)'$/)?.[1] ?? value ?? "";
  }
}
