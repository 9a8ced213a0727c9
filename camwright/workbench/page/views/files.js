// Files that a command wrote, as links to keep them.

import { blobOf } from "../api.js";
import { make } from "../elements.js";

export function links(contents, under) {
  const list = make("ul", undefined, "files");
  for (const [path, base64] of Object.entries(contents)) {
    const name = path.split("/").pop();
    if (!path.startsWith(under) || name.startsWith(".")) continue; // the list of what is ours is of no use elsewhere
    const link = Object.assign(make("a", path.slice(under.length)), { href: URL.createObjectURL(blobOf(base64, "application/octet-stream")), download: name });
    const item = make("li");
    item.append(link);
    list.append(item);
  }
  return list;
}
