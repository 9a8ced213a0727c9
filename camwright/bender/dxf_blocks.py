"""Going through a drawing as its reader sees it: block references unfolded, hidden things left out, styles resolved."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from camwright.bender.dxf_entities import is_line_work, title
from camwright.bender.dxf_guard import MOST_ENTITIES
from camwright.bender.dxf_styles import Layers, Style
from camwright.profiles.errors import InputError
from camwright.profiles.notice import Notice

_DEEPEST = 8


@dataclass(frozen=True)
class Seen:
    """An entity that is shown.

    Parameters
    ----------
    entity
        The ezdxf entity, in its place in model space.
    style
        How it is drawn.
    name
        Kind, handle and layer, for messages.
    """

    entity: Any
    style: Style
    name: str


def require_bounded(document: Any) -> None:
    """Refuse a drawing whose block references unfold to too much, before any of them is unfolded.

    Raises
    ------
    InputError
        References nested too deep, or too many entities in all.
    """
    sizes: dict[tuple[str, int], int] = {}

    def size(layout: Any, name: str, level: int) -> int:
        if (name, level) not in sizes:
            total = 0
            for entity in layout:
                if entity.dxftype() != "INSERT":
                    total += 1
                    continue
                if level == _DEEPEST:
                    raise InputError(f"{title(entity)}: blocks are nested more than {_DEEPEST} deep; explode them")
                inner = document.blocks.get(entity.dxf.name)
                if inner is not None:
                    total += max(1, entity.mcount) * size(inner, entity.dxf.name, level + 1)
            sizes[name, level] = total
        return sizes[name, level]

    if size(document.modelspace(), "", 0) > MOST_ENTITIES:
        raise InputError(f"block references unfold to more than {MOST_ENTITIES} entities; purge what is no die line")


def walk(document: Any, layers: Layers, left_out: Counter[str]) -> Iterator[Seen]:
    """Go through what is shown of model space.

    Parameters
    ----------
    document
        The ezdxf document.
    left_out
        Counts what is not shown, by what it is and why.
    """
    yield from _walk(document.modelspace(), layers, left_out, None, "")


def _walk(layout: Any, layers: Layers, left_out: Counter[str], around: Style | None, origin: str) -> Iterator[Seen]:
    for entity in layout:
        style = layers.style_of(entity, around)
        why = layers.hidden(style.layer) or ("invisible" if entity.dxf.get("invisible", 0) else "")
        if why:
            left_out[_hidden(entity, origin, style.layer, why)] += 1
        elif entity.dxftype() != "INSERT":
            yield Seen(entity, style, title(entity, origin, style.layer))
        else:
            cells = list(entity.multi_insert()) if entity.mcount > 1 else [entity]
            for number, cell in enumerate(cells, start=1):
                inside = origin or f"#{_handle(entity)}{f' ({number})' if len(cells) > 1 else ''}"
                yield from _walk(
                    cell.virtual_entities(skipped_entity_callback=_not_placed), layers, left_out, style, inside
                )


def _hidden(entity: Any, origin: str, layer: str, why: str) -> Notice:
    """Say what is not shown, and why."""
    reason = Notice(why)
    if entity.dxftype() == "INSERT":
        handle = f"#{_handle(entity)}"
        if origin:
            text = "block reference {handle} in block reference {origin} on layer {layer} ({why})"
            return Notice(text, handle=handle, origin=origin, layer=layer, why=reason)
        return Notice("block reference {handle} on layer {layer} ({why})", handle=handle, layer=layer, why=reason)
    if origin:
        return Notice(
            "entity in block reference {origin} on layer {layer} ({why})", origin=origin, layer=layer, why=reason
        )
    return Notice("entity on layer {layer} ({why})", layer=layer, why=reason)


def _handle(entity: Any) -> str:
    """Handle of an entity, of a copy its original's."""
    return str((entity if entity.dxf.handle else entity.source_of_copy).dxf.handle)


def _not_placed(entity: Any, reason: str) -> None:
    if is_line_work(entity):
        raise InputError(f"{title(entity)}: it cannot be put in the place of its block reference: {reason}")
