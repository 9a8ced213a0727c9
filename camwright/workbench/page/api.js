// Calls of the server. Each answers {ok, data}: not ok are refusals, and calls that a newer one took the place of.

const token = new URLSearchParams(location.search).get("token") ?? "";

export async function get(path) {
  const answer = await fetch(path, { headers: { "X-Camwright-Token": token } });
  return { ok: answer.ok, data: await answer.json() };
}

export async function post(name, body) {
  const answer = await fetch(`api/${name}`, {
    method: "POST",
    headers: { "Content-Type": "application/json", "X-Camwright-Token": token },
    body: JSON.stringify(body),
  });
  const data = await answer.json();
  return { ok: answer.ok && !(data.exit_code > 1) && data.status !== "stale", data };
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

export function blobOf(base64, type) {
  const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  return new Blob([bytes], { type });
}
