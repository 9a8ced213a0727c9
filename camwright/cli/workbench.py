"""The command ``camwright workbench``."""

from __future__ import annotations

import contextlib
import secrets
import socket
import sys
import threading
import webbrowser
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer
import uvicorn

from camwright.cli.main import main
from camwright.cli.options import JobOrPaper, Json
from camwright.house.files import read_text
from camwright.house.json_text import to_json
from camwright.house.toml_file import MOST_BYTES
from camwright.jobs.job import BUNDLED_JOB, parse_job
from camwright.profiles.errors import InputError
from camwright.workbench.runner import Runner
from camwright.workbench.server import application


def run(
    job: JobOrPaper = None,
    port: Annotated[int, typer.Option("--port", metavar="N", min=0, max=65535, help="Port; a free one if 0.")] = 0,
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Open no browser; print the address.")] = False,
    as_json: Json = False,
) -> int:
    """Open the workbench: see the cam, drag it, prove it, in the browser of this machine."""
    file = BUNDLED_JOB if job is None else job
    text = read_text(file, "job file", MOST_BYTES)
    parse_job(text, str(file))
    listening = _listen(port)
    token = secrets.token_urlsafe(32)
    url = f"http://127.0.0.1:{listening.getsockname()[1]}/?token={token}"
    runner = Runner(main)

    def begun() -> None:
        sys.stdout.write(to_json({"url": url}) if as_json else f"{url}\nCtrl-C ends the workbench.\n")
        sys.stdout.flush()
        if not no_browser:
            threading.Thread(target=webbrowser.open, args=(url,), daemon=True).start()

    settings = uvicorn.Config(application(text, Path(), token, runner), log_level="error", timeout_graceful_shutdown=1)
    with contextlib.suppress(KeyboardInterrupt):  # that is how it ends
        _Server(settings, runner, begun).run(sockets=[listening])
    runner.close()
    return 0


class _Server(uvicorn.Server):
    """A server that ends the solve that may run before it waits for its calls, so that all of them are answered.

    It tells when it has begun: a Ctrl-C before that would break its beginning, not end it.
    """

    def __init__(self, config: uvicorn.Config, runner: Runner, begun: Callable[[], None]) -> None:
        super().__init__(config)
        self._runner = runner
        self._begun = begun

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin."""
        await super().startup(sockets)
        self._begun()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """End."""
        self._runner.close()
        await super().shutdown(sockets)


def _listen(port: int) -> socket.socket:
    """Listen on this machine alone.

    Raises
    ------
    InputError
        The port is taken, or not for everybody.
    """
    # asyncio sends answers without delay (TCP_NODELAY) only where the protocol is named: else each may wait 40 ms for the browser
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind(("127.0.0.1", port))
    except OSError as error:
        listening.close()
        raise InputError(
            f"--port {port}: cannot be listened on: {error.strerror}; leave it out for a free one"
        ) from error
    listening.listen(64)
    return listening
