"""Trio Motion Coordinator: a cycle of ``MOVELINK`` calls. Read, not written."""

from __future__ import annotations

import re
from dataclasses import dataclass

from camwright.profiles.tables.cam_table import CamTable, PieceLaw, make_table
from camwright.profiles.tables.interpolation import by_law
from camwright.profiles.tables.target import Target, not_written
from camwright.profiles.tables.text import real, refuse, shown
from camwright.profiles.tables.trio import known_numbers, numbered_statements

MOST_MOVES = 5_000

SIGN = r"\bMOVELINK[ \t]{0,9}\("
"""What a text with such calls has."""

_CALL = re.compile(r"MOVELINK\s{0,9}\(([^()]*)\)(?:\s{0,9}AXIS\s{0,9}\(([^()]*)\))?", re.IGNORECASE)
_BASE = re.compile(r"BASE\s{0,9}\(([^(),]*)[^()]*\)", re.IGNORECASE)
_OTHER = re.compile(r"(?:.*\bTHEN\s+)?(MOVELINK|FLEXLINK|MOVE|MOVEABS|CAMBOX|CONNECT)\b.*", re.IGNORECASE)


@dataclass(frozen=True)
class _Move:
    """One call: slave and link distance, how much of the latter it speeds up and slows down over, its line."""

    distance: float
    link: float
    speeding: float
    slowing: float
    line: int

    @property
    def ratio(self) -> float:
        """Ratio between speeding up and slowing down: half of either counts."""
        return self.distance / (self.link - 0.5 * (self.speeding + self.slowing))


def read(text: str, place: str) -> CamTable:
    """Knots of the calls in the order of the file, as one cycle: ratios rise and fall straight over the link axis, so pieces are parabolas.

    Raises
    ------
    InputError
        A call whose arguments are no numbers or make no motion, calls of several axes, another motion among them, or a call that begins
        from standstill while the one before ends moving.
    """
    moves, axes = [], set()
    base = ""
    known = known_numbers(text, place)
    for number, statement in numbered_statements(text, place):
        call, chosen, other = _CALL.fullmatch(statement), _BASE.fullmatch(statement), _OTHER.fullmatch(statement)
        if chosen:
            base = chosen[1].strip()
        elif call:
            moves.append(_move(call[1], known, place, number))
            axes.add((call[2] if call[2] is not None else base).strip().lower())
        elif other:
            raise refuse(
                place,
                number,
                f"{shown(statement)} is not read beside MOVELINK calls; leave those of one cycle in the file",
            )
        if len(axes) > 1 or len(moves) > MOST_MOVES:
            what = "move more than one axis" if len(axes) > 1 else f"are more than {MOST_MOVES}"
            raise refuse(place, number, f"the MOVELINK calls {what}; leave those of one cycle of one axis in the file")
    if not moves:
        raise refuse(
            place, None, "there is no call MOVELINK(distance, link distance, acceleration, deceleration, link axis)"
        )
    return _joined(moves, place)


def _move(arguments: str, known: dict[str, str | None], place: str, number: int) -> _Move:
    """Take one call; where both ramps are longer than the link distance the controller shortens them in proportion."""
    cells = [cell.strip() for cell in arguments.split(",")]
    if len(cells) < 5:
        raise refuse(place, number, f"MOVELINK({shown(arguments)}) has {len(cells)} arguments, not 5 or more")
    distance, link, speeding, slowing = (real(known.get(cell.lower()) or cell, place, number) for cell in cells[:4])
    if not (link > 0.0 and speeding >= 0.0 and slowing >= 0.0):
        raise refuse(place, number, f"MOVELINK over {link:g}, with ramps of {speeding:g} and {slowing:g}, is no motion")
    share = min(1.0, link / (speeding + slowing)) if speeding + slowing else 1.0
    return _Move(distance, link, share * speeding, share * slowing, number)


def _joined(moves: list[_Move], place: str) -> CamTable:
    """Put the moves one behind the other."""
    x, y, ratios = [0.0], [0.0], [0.0 if moves[0].speeding else moves[0].ratio]
    laws: list[PieceLaw] = []
    for move in moves:
        begins = 0.0 if move.speeding else move.ratio
        curved = bool(laws) and laws[-1] == "cubic"
        if begins != ratios[-1] and curved and move.speeding:
            raise refuse(place, move.line, "MOVELINK begins from standstill while the call before it ends moving")
        if not curved:
            ratios[-1] = begins
        even = move.link - move.speeding - move.slowing
        for width, first, last, law in (
            (move.speeding, 0.0, move.ratio, "cubic"),
            (even if even > 1e-12 * move.link else 0.0, move.ratio, move.ratio, "line"),
            (move.slowing, move.ratio, 0.0, "cubic"),
        ):
            if width:
                x.append(x[-1] + width)
                y.append(y[-1] + 0.5 * (first + last) * width)
                ratios.append(last)
                laws.append("cubic" if law == "cubic" else "line")
    note = (
        f"{len(moves)} MOVELINK calls in the order of the file are taken as one cycle over a link distance of {x[-1]:g}"
    )
    return make_table(x, y, ratios, law=tuple(laws), notes=(note,))


LAYOUT = Target(
    name="trio-movelink",
    title="Trio Motion Coordinator, MOVELINK calls",
    interpolation="ratios that rise and fall straight over the link axis",
    law="line",
    spacing="free",
    max_points=3 * MOST_MOVES + 1,
    number_format="float64",
    evidence=(
        "MOVELINK: Trio technical reference (a linear move whose acceleration and deceleration phases are distances of the link axis, both "
        "shortened in proportion where they are longer than it). That the ratio is straight over them is inferred from its examples, "
        "which speed up over twice the distance moved."
    ),
    steps=(),
    endings=(),
    write=not_written,
    read=read,
    rebuild=by_law,
)
