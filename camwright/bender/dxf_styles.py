"""`Style`: the layer, colour and linetype by which a drawing tells cut, crease and half-cut lines apart."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from camwright.bender.piece import Piece
from camwright.profiles.bender.bridges import BridgeMark
from camwright.profiles.errors import InputError

_BYBLOCK, _BYLAYER = 0, 256
_WHITE = "7"
_KEYS = ("layer", "colour", "linetype")


@dataclass(frozen=True)
class Style:
    """How a line is drawn, what it takes from its layer and its block reference resolved.

    Parameters
    ----------
    layer
        Name of the layer.
    colour
        Number of the colour, or ``#rrggbb``.
    linetype
        Name of the linetype.
    """

    layer: str
    colour: str
    linetype: str

    @property
    def key(self) -> tuple[str, str, str]:
        """What makes it differ from other styles: names are alike in any case."""
        return self.layer.casefold(), self.colour.casefold(), self.linetype.casefold()

    def __str__(self) -> str:
        return f"layer={self.layer},colour={self.colour},linetype={self.linetype}"


MODEL_SPACE = Style("0", _WHITE, "Continuous")
"""What an entity in model space takes that says BYBLOCK."""


@dataclass(eq=False)
class StylePieces:
    """What one style holds: its name as first seen, its pieces (m), what cannot be bent, and bridges of its own with their widths (m)."""

    style: Style
    pieces: list[Piece] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    bridges: list[tuple[BridgeMark, float]] = field(default_factory=list)


@dataclass(frozen=True)
class StyleChoice:
    """Which styles are bent.

    Parameters
    ----------
    layer, colour, linetype
        What a style must have; ``None`` for any.
    each
        Bend each style that fits; else there may be one only.
    """

    layer: str | None = None
    colour: str | None = None
    linetype: str | None = None
    each: bool = False

    def fits(self, style: Style) -> bool:
        """Whether a style is asked for."""
        asked = (self.layer, self.colour, self.linetype)
        return all(want is None or want.casefold() == has for want, has in zip(asked, style.key, strict=True))

    def __str__(self) -> str:
        asked = zip(_KEYS, (self.layer, self.colour, self.linetype), strict=True)
        return ",".join(f"{key}={value}" for key, value in asked if value is not None)


def style_choice(text: str | None, layer: str | None, *, each: bool) -> StyleChoice:
    """Read what is asked for on the command line.

    Parameters
    ----------
    text
        Such as ``layer=CUT,colour=1``.
    layer
        Name of a layer, given beside it.
    each
        Whether each style that fits is bent.

    Raises
    ------
    InputError
        It is no such text, or names two layers.
    """
    asked: dict[str, str] = {}
    for part in re.split(rf",\s*(?=(?:{'|'.join(_KEYS)})\s*=)", text or "") if text is not None else ():
        key, _, value = (word.strip() for word in part.partition("="))
        if key not in _KEYS or not value or key in asked:
            raise InputError(
                f"--style {text!r}: not a style; write some of layer=, colour= and linetype=, e.g. "
                "--style layer=CUT,colour=1"
            )
        asked[key] = value
    if layer is not None and asked.setdefault("layer", layer).casefold() != layer.casefold():
        raise InputError(f"--layer {layer} and --style {text} name two layers; name one")
    return StyleChoice(asked.get("layer"), asked.get("colour"), asked.get("linetype"), each)


class Layers:
    """The layers of a document, whether they stand in its table or not."""

    def __init__(self, entries: Iterable[Any]) -> None:
        self._entries = {entry.dxf.name.casefold(): entry for entry in entries}

    @property
    def names(self) -> set[str]:
        """Names in the table."""
        return {entry.dxf.name for entry in self._entries.values()}

    def hidden(self, name: str) -> str:
        """Why a layer is not shown; empty if it is."""
        entry = self._entries.get(name.casefold())
        return "" if entry is None or not (entry.is_frozen() or entry.is_off()) else "off or frozen"

    def style_of(self, entity: Any, around: Style | None) -> Style:
        """Resolve an entity's style.

        Parameters
        ----------
        entity
            The ezdxf entity.
        around
            Style of the block reference that it stands in; ``None`` in model space.
        """
        layer = entity.dxf.layer if around is None or entity.dxf.layer != "0" else around.layer
        entry = self._entries.get(layer.casefold())
        block = around or MODEL_SPACE
        return Style(layer, self._colour(entity, entry, block), _linetype(entity, entry, block))

    @staticmethod
    def _colour(entity: Any, entry: Any, block: Style) -> str:
        true, number = entity.dxf.get("true_color"), entity.dxf.get("color", _BYLAYER)
        if true is not None:
            return f"#{true & 0xFFFFFF:06x}"
        if number == _BYBLOCK:
            return block.colour
        if 0 < number < _BYLAYER:
            return str(number)
        if entry is None:
            return _WHITE
        true = entry.dxf.get("true_color")
        return f"#{true & 0xFFFFFF:06x}" if true is not None else str(abs(entry.dxf.get("color", 7)))


def _linetype(entity: Any, entry: Any, block: Style) -> str:
    name = str(entity.dxf.get("linetype", "BYLAYER"))
    if name.casefold() == "byblock":
        return block.linetype
    if name.casefold() != "bylayer":
        return name
    return MODEL_SPACE.linetype if entry is None else str(entry.dxf.get("linetype", MODEL_SPACE.linetype))
