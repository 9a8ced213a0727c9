// Files that a command wrote, as links to keep them.

import { blobOf } from "../api.js";
import { make } from "../elements.js";

const TYPES = { pdf: "application/pdf", html: "text/html", svg: "image/svg+xml", csv: "text/csv" };

export const typeOf = (path) => TYPES[path.split(".").pop()] ?? "application/octet-stream";

export function links(contents, under) {
  const list = make("ul", undefined, "files");
  for (const [path, base64] of Object.entries(contents)) {
    if (!path.startsWith(under)) continue;
    const link = Object.assign(make("a", path.slice(under.length)), { href: URL.createObjectURL(blobOf(base64, "application/octet-stream")), download: path.split("/").pop() });
    const item = make("li");
    item.append(link);
    list.append(item);
  }
  return list;
}
