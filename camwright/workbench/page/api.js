// Calls of the server. Each answers {ok, data}: not ok are refusals, and calls that a newer one took the place of.

const token = new URLSearchParams(location.search).get("token") ?? "";
const HEADERS = { "X-Camwright-Token": token };

/** The workbench ended, or cannot be reached: told once as a refusal like any other. */
const gone = () => ({ ok: false, data: { status: "gone", message: "The workbench has ended. Start it again: camwright workbench" } });

export async function get(path) {
  try {
    const answer = await fetch(path, { headers: HEADERS });
    return { ok: answer.ok, data: await answer.json() };
  } catch {
    return gone();
  }
}

/** Call by name; what is aborted is no longer worked on. */
export async function post(name, body, signal) {
  try {
    const answer = await fetch(`api/${name}`, { method: "POST", signal, headers: { ...HEADERS, "Content-Type": "application/json" }, body: JSON.stringify(body) });
    const data = await answer.json();
    return { ok: answer.ok && !(data.exit_code > 1) && data.status !== "stale", data };
  } catch (error) {
    return error.name === "AbortError" ? { ok: false, data: { status: "stale" } } : gone();
  }
}

/** Runs one call at a time and only the newest of those that wait: a hand moves faster than a solver. */
export function newestOnly(run) {
  let busy = false;
  let next = null;
  return async function ask(argument) {
    next = { argument };
    if (busy) return;
    busy = true;
    while (next) {
      const { argument: now } = next;
      next = null;
      await run(now);
    }
    busy = false;
  };
}

const bytesOf = (base64) => Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));

export const blobOf = (base64, type) => new Blob([bytesOf(base64)], { type });
export const textOf = (base64) => new TextDecoder().decode(bytesOf(base64));

/** A chosen file as the server takes it. */
export async function sent(file) {
  const bytes = new Uint8Array(await file.arrayBuffer());
  let text = "";
  for (let at = 0; at < bytes.length; at += 32768) text += String.fromCharCode(...bytes.subarray(at, at + 32768));
  return { name: file.name, base64: btoa(text) };
}
