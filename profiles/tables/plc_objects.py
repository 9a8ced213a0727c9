"""TwinCAT's source files (``.TcPOU``, ``.TcGVL``): the structured text inside the XML, each line where it stands."""

from __future__ import annotations

import html
import re

from camwright.profiles.tables.text import refuse

_OBJECT = re.compile(r"\A\s{0,99}(?:<\?xml[^>]{0,200}\?>\s{0,99})?<TcPlcObject\b")
_PARTS = ("Declaration", "ST")


def program_text(text: str, place: str) -> str:
    """Give the structured text of a TwinCAT source file; any other text as it is.

    What is no structured text becomes empty lines, so that messages name the line of the file.

    Raises
    ------
    InputError
        A part that begins and does not end, or a file without structured text.
    """
    if not _OBJECT.match(text):
        return text
    found: list[tuple[int, int, str]] = []
    for part in _PARTS:
        begin = 0
        while (start := text.find(f"<{part}>", begin)) >= 0:
            start += len(part) + 2
            end = text.find(f"</{part}>", start)
            if end < 0:
                raise refuse(place, text.count("\n", 0, start) + 1, f"the part <{part}> begins here and never ends")
            found.append((start, end, _plain(text[start:end])))
            begin = end
    if not found:
        raise refuse(place, None, "there is no structured text in it: neither <Declaration> nor <ST>")
    parts: list[str] = []
    at = 0
    for start, end, plain in sorted(found):
        if start < at:
            continue
        parts += ["\n" * text.count("\n", at, start) or " ", plain]  # END_VAR does not run into the first name
        at = end
    return "".join(parts) + "\n"


def _plain(inside: str) -> str:
    """Unwrap character data, or put back signs that XML writes with an ampersand."""
    stripped = inside.strip()
    if stripped.startswith("<![CDATA[") and stripped.endswith("]]>"):
        lead = inside[: len(inside) - len(inside.lstrip())]
        return lead + stripped.removeprefix("<![CDATA[").removesuffix("]]>")
    return html.unescape(inside)
