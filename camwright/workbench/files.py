"""`PageFiles`: the page and the modules that it is made of, read once: a browser asks for all of them before it shows anything."""

from __future__ import annotations

from pathlib import Path

from starlette.requests import Request
from starlette.responses import Response

PAGE = Path(__file__).parent / "page"
"""The page's files."""

_KINDS = {".html": "text/html", ".js": "text/javascript", ".css": "text/css"}
"""What a browser is told of a file; what has none of these endings is not sent."""


class PageFiles:
    """Answers with the page's files; one that is not among them there is not, whatever its path says."""

    def __init__(self) -> None:
        self._known = {
            file.relative_to(PAGE).as_posix(): file.read_text(encoding="utf-8")
            for file in sorted(PAGE.rglob("*"))
            if file.suffix in _KINDS
        }
        # without these a browser finds the modules one round after the other, as they name each other
        links = "".join(
            f'<link rel="modulepreload" href="page/{name}">\n' for name in self._known if name.endswith(".js")
        )
        self._index = self._known.pop("index.html").replace("</head>", f"{links}</head>")

    async def index(self, _: Request) -> Response:
        """Give the page."""
        return Response(self._index, media_type=_KINDS[".html"])

    async def file(self, request: Request) -> Response:
        """Give a module or a style of the page."""
        name = request.path_params["name"]
        text = self._known.get(name)
        if text is None:
            return Response("no such file", 404, media_type="text/plain")
        return Response(text, media_type=_KINDS[Path(name).suffix])
