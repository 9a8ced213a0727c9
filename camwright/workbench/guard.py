"""`Guard`: who may speak to the workbench. It listens on this machine only, and only to a page that knows its token."""

from __future__ import annotations

import asyncio
import hmac
from collections.abc import Awaitable, Callable, MutableMapping
from typing import Any
from urllib.parse import parse_qs

from starlette.responses import JSONResponse

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

MOST_BYTES = 8 << 20
"""The most bytes that a call may have."""

MOST_SECONDS = 30.0
"""How long the body of a call may take to come."""

POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; frame-src blob:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
"""What the page may load: nothing of anyone else's."""

_HEADERS = (
    (b"content-security-policy", POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cache-control", b"no-store"),
)


class Guard:
    """Checks Host, Origin, token and size before a call goes on, and sends the policy with every answer.

    Parameters
    ----------
    app
        What is guarded.
    token
        What callers must know, as the query's ``token`` or the header ``X-Camwright-Token``; style and scripts of the page need none.
    """

    def __init__(self, app: App, token: str) -> None:
        self._app, self._token = app, token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let a call through, or refuse it."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def sending(message: MutableMapping[str, Any]) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = [*message.get("headers", []), *_HEADERS]
            await send(message)

        refused = self._refused(scope)
        if refused is not None:
            await _answer(*refused)(scope, receive, sending)
            return
        if scope["method"] != "POST":
            await self._app(scope, receive, sending)
            return
        try:
            async with asyncio.timeout(MOST_SECONDS):
                body = await _body(receive)
        except TimeoutError:
            body = (408, f"the body of a call did not come within {MOST_SECONDS:g} s")
        if body is None:
            return
        if isinstance(body, tuple):
            await _answer(*body)(scope, receive, sending)
            return
        waiting = [{"type": "http.request", "body": body, "more_body": False}]

        async def received() -> MutableMapping[str, Any]:
            return waiting.pop() if waiting else await receive()

        await self._app(scope, received, sending)

    def _refused(self, scope: Scope) -> tuple[int, str] | None:
        """Say why a call is refused, with its status."""
        headers = {name.decode("latin-1").lower(): value.decode("latin-1") for name, value in scope["headers"]}
        host = headers.get("host", "")
        server = scope.get("server") or ("127.0.0.1", 0)
        if host not in {f"{name}:{server[1]}" for name in ("127.0.0.1", "localhost")}:
            return 403, "another host"
        origin = headers.get("origin")
        if origin is not None and origin != f"http://{host}":
            return 403, "another origin"
        if headers.get("content-length", "0").isdigit() and int(headers.get("content-length", "0")) > MOST_BYTES:
            return 413, f"a call has at most {MOST_BYTES} bytes"
        if scope["path"].startswith("/page/"):
            return None
        given = (
            headers.get("x-camwright-token") or parse_qs(scope["query_string"].decode("latin-1")).get("token", [""])[0]
        )
        if not hmac.compare_digest(given.encode(), self._token.encode()):
            return 403, "the token is missing or wrong; open the address that camwright workbench printed"
        return None


async def _body(receive: Receive) -> bytes | tuple[int, str] | None:
    """Read the body of a call; a status and why where it is too large, nothing where the caller has gone."""
    body = bytearray()
    while True:
        message = await receive()
        if message["type"] == "http.disconnect":
            return None
        body += message.get("body", b"")
        if len(body) > MOST_BYTES:
            return 413, f"a call has at most {MOST_BYTES} bytes"
        if not message.get("more_body", False):
            return bytes(body)


def _answer(status: int, message: str) -> JSONResponse:
    """Answer a call that is refused, and listen to it no longer."""
    return JSONResponse({"status": "error", "message": message}, status, {"connection": "close"})
