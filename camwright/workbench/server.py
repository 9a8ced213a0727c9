"""The workbench's server: the page, and the calls that it makes."""

from __future__ import annotations

import asyncio
import base64
import contextlib
import json
import re
from collections.abc import AsyncIterator, Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from camwright.answers.error import error_answer
from camwright.house.language import LANGUAGES
from camwright.jobs.job import parse_job
from camwright.jobs.keys import job_keys
from camwright.jobs.wording import error_words
from camwright.profiles.errors import CamwrightError, InputError
from camwright.profiles.returns import baseline_names
from camwright.profiles.tables.targets import TARGETS
from camwright.workbench.calls import (
    NAMES,
    PageCall,
    call_of,
    file_of,
    flag_of,
    job_text,
    language_of,
    laws_of,
    number_of,
    text_of,
)
from camwright.workbench.files import PageFiles
from camwright.workbench.guard import Guard
from camwright.workbench.overlay import overlay
from camwright.workbench.preview import drawn_design, preview
from camwright.workbench.runner import JOB_FILE, Ran, Runner, StaleError
from camwright.workbench.saving import Saved
from camwright.workbench.servo import servo_view
from camwright.workbench.words import page_words

_NO_CALL = 422
"""Status of a call that is not what it should be; what a command refuses is an answer like any other."""

_STALE = JSONResponse({"status": "stale", "message": "a newer call took its place"})

_PLACE = re.compile(r"\[([a-z_.]+)\] ([a-z_]+)")


class Workbench:
    """The page and its calls.

    Parameters
    ----------
    text
        The job that the page begins with.
    folder
        Where the page saves: ``job.toml`` and ``design.json``, nothing else.
    runner
        What runs commands.
    """

    def __init__(self, text: str, folder: Path, runner: Runner) -> None:
        self._text, self._saved, self._runner = text, Saved(folder, text), runner

    async def job(self, _: Request) -> Response:
        """Give what the page begins with: the job, the keys that its form is made from, targets, baselines, languages."""
        job = parse_job(self._text, JOB_FILE)
        task = job.task if job.machine.placed else job.task.placed_midway()
        return JSONResponse(
            {
                "toml": self._text,
                "name": job.name,
                "keys": [{"path": key.path, **asdict(key)} for key in job_keys()],
                "targets": list(TARGETS),
                "laws": list(baseline_names(task)),
                "languages": list(LANGUAGES),
            }
        )

    async def words(self, request: Request) -> Response:
        """Give the words of a language: those of the page, and of the recipes what both name."""
        try:
            language = language_of(request.query_params)
        except InputError as error:
            return _refusal(error, _NO_CALL)
        return JSONResponse(page_words(language))

    async def at_once(self, request: Request) -> Response:
        """Answer what takes no solver, or hardly one, beside the command that may run."""
        name = request.url.path.rpartition("/")[2]
        try:
            answer = _AT_ONCE[name](await _body(request))
        except InputError as error:
            return _refusal(error, _NO_CALL)
        self._runner.asked()
        try:
            return JSONResponse(await run_in_threadpool(answer))
        except CamwrightError as error:
            return _refusal(error)

    async def call(self, request: Request) -> Response:
        """Run the command that the path names."""
        name = request.url.path.rpartition("/")[2]
        try:
            call = call_of(name, await _body(request))
        except InputError as error:
            return _refusal(error, _NO_CALL)
        try:
            return _answered(await self._run(request, name, call))
        except StaleError:
            return _STALE

    async def _run(self, request: Request, name: str, call: PageCall) -> Ran:
        """Run a call as long as somebody waits for it."""
        run = asyncio.create_task(self._runner.run(name, call.commands, call.inputs))
        gone = asyncio.create_task(_gone(request))
        await asyncio.wait({run, gone}, return_when=asyncio.FIRST_COMPLETED)
        gone.cancel()
        if not run.done():
            self._runner.forget(name)
        return await run

    async def save(self, request: Request) -> Response:
        """Design a job, and write both where the workbench was started."""
        try:
            body = await _body(request)
            text, call = job_text(body), call_of("design", {**body, "brief": True})
        except InputError as error:
            return _refusal(error, _NO_CALL)
        try:
            ran = await self._runner.run("save", call.commands, call.inputs)
            if ran.exit_code > 1:
                return _answered(ran)
            self._saved.put(text, ran.files["out/design.json"])
        except InputError as error:
            return _refusal(error)
        except StaleError:
            return _STALE
        return JSONResponse({"files": [JOB_FILE, "design.json"]})


def application(text: str, folder: Path, token: str, runner: Runner) -> Guard:
    """Make the application.

    Parameters
    ----------
    text, folder
        As of `Workbench`.
    token
        What callers must know.
    runner
        What answers their calls; it is closed with the application.
    """
    bench, files = Workbench(text, folder, runner), PageFiles()

    @contextlib.asynccontextmanager
    async def living(_: Starlette) -> AsyncIterator[None]:
        yield
        runner.close()

    routes = [
        Route("/", files.index),
        Route("/page/{name:path}", files.file),
        Route("/api/job", bench.job),
        Route("/api/words", bench.words),
        *(Route(f"/api/{name}", bench.at_once, methods=["POST"]) for name in _AT_ONCE),
        Route("/api/save", bench.save, methods=["POST"]),
        *(Route(f"/api/{name}", bench.call, methods=["POST"]) for name in NAMES),
    ]
    return Guard(Starlette(routes=routes, lifespan=living), token)


def _preview(body: dict[str, Any]) -> Callable[[], dict[str, Any]]:
    text, laws = job_text(body), laws_of(body)
    place = None if body.get("place") is None else number_of(body, "place", 0.0)
    return lambda: preview(text, laws, place)


def _cam(body: dict[str, Any]) -> Callable[[], dict[str, Any]]:
    text, laws = text_of(body, "design"), laws_of(body)
    return lambda: drawn_design(text, laws)


def _servo(body: dict[str, Any]) -> Callable[[], dict[str, Any]]:
    design, share, curve = text_of(body, "design"), number_of(body, "share", 1.0), flag_of(body, "curve")
    return lambda: servo_view(design, share, curve=curve)


def _overlay(body: dict[str, Any]) -> Callable[[], dict[str, Any]]:
    text, (name, data) = job_text(body), file_of(body)
    units, design = (text_of(body, key) if body.get(key) else None for key in ("units", "design"))
    return lambda: overlay(text, data, name, units, design)


_AT_ONCE: dict[str, Callable[[dict[str, Any]], Callable[[], dict[str, Any]]]] = {
    "preview": _preview,
    "cam": _cam,
    "servo": _servo,
    "overlay": _overlay,
}
"""Calls that are answered beside the command that may run, each made from what the page sends."""


async def _gone(request: Request) -> None:
    """Wait until the caller has gone."""
    while (await request.receive())["type"] != "http.disconnect":
        pass


async def _body(request: Request) -> dict[str, Any]:
    """Read the body of a call.

    Raises
    ------
    InputError
        It is no JSON object.
    """
    try:
        body = json.loads(await request.body())
    except (ValueError, RecursionError) as error:
        raise InputError("the body is no JSON, or nested too deeply") from error
    if not isinstance(body, dict):
        raise InputError('the body is no JSON object; send {"toml": "…"}')
    return body


def _answered(ran: Ran) -> Response:
    """Answer with what the command line answered, a failure with the faults by their fields."""
    answer = json.loads(ran.answer) if ran.answer else {}
    if ran.exit_code > 1:
        return JSONResponse({**answer, "faults": faults(str(answer.get("message", "")))})
    files = {path: base64.b64encode(data).decode() for path, data in ran.files.items()}
    return JSONResponse({"exit_code": ran.exit_code, **answer, "contents": files})


def _refusal(error: CamwrightError, status: int = 200) -> Response:
    """Answer with a refusal as the command line words it; the status is that of a good call unless the call itself is no good."""
    message = "\n".join(error_words(error))
    return JSONResponse({**error_answer(error.exit_code, message, error), "faults": faults(message)}, status)


def faults(message: str) -> list[dict[str, str | None]]:
    """Split a refusal into its faults, each with the field of the form that it is about.

    Examples
    --------
    >>> faults("job.toml: [cut] length = 5: a number without a unit")
    [{'field': 'cut.length', 'message': 'job.toml: [cut] length = 5: a number without a unit'}]
    """
    found: list[dict[str, str | None]] = []
    for line in message.splitlines():
        place = _PLACE.search(line)
        found.append({"field": ".".join(place.groups()) if place else None, "message": line})
    return found
