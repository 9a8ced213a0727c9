"""Trio Motion Coordinator: a cycle of ``MOVELINK`` and ``FLEXLINK`` calls. Read, not written."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial

from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.tables.cam_table import CamTable, PieceLaw, make_table
from camwright.profiles.tables.target import Target
from camwright.profiles.tables.text import refuse, shown
from camwright.profiles.tables.trio_program import Numbers, numbered_statements

MOST_MOVES = 1_000

SIGN = r"(?m)\b(?:MOVE|FLEX)LINK[ \t]{0,9}\(|^[ \t]{0,99}ML[ \t]{0,9}\("
"""What a text with such calls has."""

_CALL = re.compile(r"(MOVELINK|ML|FLEXLINK)\s{0,9}\((.*?)\)(?:\s{0,9}AXIS\s{0,9}\(([^()]*)\))?", re.IGNORECASE)
_BASE = re.compile(r"BASE\s{0,9}\(([^(),]*)[^()]*\)", re.IGNORECASE)
_OTHER = re.compile(
    r"(?:.*\bTHEN\s+)?(MOVELINK|ML|FLEXLINK|MOVE|MOVEABS|CAM|CAMBOX|CONNECT|MOVECIRC|FORWARD|REVERSE|ADDAX)\b.*",
    re.IGNORECASE,
)

_CURVED = 1 << 4
"""Option of MOVELINK: its ramps are curves of the kind in the bits 10 to 12; without it they are straight."""
_SINE, _STRAIGHT = 0, 4
_SMOOTH = {
    3: Polynomial([0, 0, 0, 10, -15, 6]),
    2: Polynomial([0, 0, 0, 0, 35, -84, 70, -20]),
    1: Polynomial([0, 0, 0, 0, 0, 126, -420, 540, -315, 70]),
}
"""Ratio over a ramp from 0 to 1, by the kind of the option: polynomials of power 5, 7 and 9, flat at both ends."""

_PARTS = 32
"""Quintics that a curved ramp is laid out as: they miss its acceleration by less than 1e-5 of its peak."""


@dataclass(frozen=True)
class _Move:
    """One call: an even ratio throughout, and on it a travel of its own over part of the way.

    ``before`` and ``after`` are the link distances without that travel, ``speeding`` and ``slowing`` those of its ramps,
    ``even`` that between them; ``line`` is where the call stands.
    """

    base: float
    rise: float
    before: float
    speeding: float
    even: float
    slowing: float
    after: float
    curve: int
    line: int

    def spans(self) -> Iterator[tuple[float, float, float]]:
        """Width and the ratios at both ends of what the call is made of."""
        top = self.base + self.rise
        for width, first, last in (
            (self.before, self.base, self.base),
            (self.speeding, self.base, top),
            (self.even, top, top),
            (self.slowing, top, self.base),
            (self.after, self.base, self.base),
        ):
            if width > 1e-12 * (self.before + self.speeding + self.even + self.slowing + self.after):
                yield width, first, last


def read(text: str, place: str) -> CamTable:
    """Knots of the calls in the order of the file, as one cycle.

    Raises
    ------
    InputError
        A call whose arguments are no numbers or make no motion, calls of several axes, another motion among them, or a ramp that begins
        at another ratio than the ramp before it ends at.
    """
    moves, axes = [], set()
    base = ""
    numbers = Numbers.of(text, place)
    for number, statement in numbered_statements(text, place):
        call, chosen, other = _CALL.fullmatch(statement), _BASE.fullmatch(statement), _OTHER.fullmatch(statement)
        if chosen:
            base = chosen[1].strip()
        elif call:
            make = _flexed if call[1].upper() == "FLEXLINK" else _linked
            moves.append(make(call[2].split(","), numbers, place, number))
            axes.add((call[3] if call[3] is not None else base).strip().lower())
        elif other:
            raise refuse(
                place,
                number,
                f"{shown(statement)} is not read beside linked moves; leave the calls of one cycle in the file",
            )
        if len(axes) > 1 or len(moves) > MOST_MOVES:
            what = "move more than one axis" if len(axes) > 1 else f"are more than {MOST_MOVES}"
            raise refuse(place, number, f"the linked moves {what}; leave those of one cycle of one axis in the file")
    if not moves:
        raise refuse(
            place, None, "there is no call MOVELINK(distance, link distance, acceleration, deceleration, link axis)"
        )
    return _joined(moves, place)


def _linked(cells: list[str], numbers: Numbers, place: str, number: int) -> _Move:
    """Take one ``MOVELINK``; where both ramps are longer than the link distance the controller shortens them in proportion."""
    if len(cells) < 5:
        raise refuse(place, number, f"MOVELINK({shown(', '.join(cells))}) has {len(cells)} arguments, not 5 or more")
    distance, link, speeding, slowing = (numbers.value(cell, place, number) for cell in cells[:4])
    based = numbers.value(cells[7], place, number) if len(cells) > 7 else 0.0
    options = _options(cells, 5, numbers, place, number)
    if not (link > 0.0 and speeding >= 0.0 and slowing >= 0.0):
        raise refuse(place, number, f"MOVELINK over {link:g}, with ramps of {speeding:g} and {slowing:g}, is no motion")
    share = min(1.0, link / (speeding + slowing)) if speeding + slowing else 1.0
    speeding, slowing = share * speeding, share * slowing
    even = link - speeding - slowing
    rise = (distance - based) / (even + 0.5 * (speeding + slowing))
    curve = _curve(options, place, number) if options & _CURVED else _STRAIGHT
    return _Move(based / link, rise, 0.0, speeding, even, slowing, 0.0, curve, number)


def _flexed(cells: list[str], numbers: Numbers, place: str, number: int) -> _Move:
    """Take one ``FLEXLINK``: an even move, and a travel between the parts of the way, in per cent, that are left to it."""
    if len(cells) < 8:
        raise refuse(place, number, f"FLEXLINK({shown(', '.join(cells))}) has {len(cells)} arguments, not 8 or more")
    based, excited, link, *parts = (numbers.value(cell, place, number) for cell in cells[:7])
    before, after, speeding, slowing = parts
    room = 100.0 - before - after
    if not (link > 0.0 and min(parts) >= 0.0 and room >= 0.0 and speeding + slowing <= 100.0 and (room or not excited)):
        raise refuse(
            place,
            number,
            f"FLEXLINK over {link:g}, with {before:g} and {after:g} % of it left out and ramps of {speeding:g} and "
            f"{slowing:g} % of the rest, is no motion",
        )
    window = 0.01 * room * link
    up, down = 0.01 * speeding * window, 0.01 * slowing * window
    even = window - up - down
    rise = excited / (even + 0.5 * (up + down)) if window else 0.0
    curve = _curve(_options(cells, 8, numbers, place, number), place, number)
    return _Move(based / link, rise, 0.01 * before * link, up, even, down, 0.01 * after * link, curve, number)


def _options(cells: list[str], at: int, numbers: Numbers, place: str, number: int) -> int:
    """Read the bits of the options, 0 where they are left out."""
    return numbers.whole(cells[at], place, number) if len(cells) > at else 0


def _curve(options: int, place: str, number: int) -> int:
    """Read the kind of the ramps from the bits 10 to 12."""
    kind = options >> 10 & 7
    if kind > _STRAIGHT:
        raise refuse(
            place,
            number,
            f"the bits 10 to 12 of the options {options} ask for the curve {kind}; there are 0 to {_STRAIGHT}",
        )
    return kind


def _ramp(curve: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Integral, value and slope of the ratio over a ramp from 0 to 1 of width 1, at `_PARTS` even steps; shapes ``(_PARTS,)``."""
    t = np.arange(1, _PARTS + 1) / _PARTS
    if curve == _SINE:
        return (
            0.5 * (t - np.sin(np.pi * t) / np.pi),
            0.5 * (1.0 - np.cos(np.pi * t)),
            0.5 * np.pi * np.sin(np.pi * t),
        )
    shape = _SMOOTH[curve]
    return shape.integ()(t), shape(t), shape.deriv()(t)


def _joined(moves: list[_Move], place: str) -> CamTable:
    """Put the moves one behind the other."""
    x, y, ratios, slopes = [0.0], [0.0], [0.0], [0.0]
    laws: list[PieceLaw] = []
    for move in moves:
        for width, first, last in move.spans():
            ramp = first != last
            if (
                ramp
                and laws
                and laws[-1] != "line"
                and abs(first - ratios[-1]) > 1e-6 * max(abs(first), abs(ratios[-1]))
            ):
                raise refuse(
                    place,
                    move.line,
                    f"the move begins at the ratio {first:g} while the ramp before it ends at {ratios[-1]:g}",
                )
            if not laws or laws[-1] == "line":
                ratios[-1] = first
            begin, low = x[-1], y[-1]
            if ramp and move.curve != _STRAIGHT:
                area, value, slope = _ramp(move.curve)
                rise = last - first
                x += (begin + width * np.arange(1, _PARTS + 1) / _PARTS).tolist()
                y += (low + width * (first * np.arange(1, _PARTS + 1) / _PARTS + rise * area)).tolist()
                ratios += (first + rise * value).tolist()
                slopes += (rise / width * slope).tolist()
                laws += ["quintic"] * _PARTS
            else:
                x.append(begin + width)
                y.append(low + 0.5 * (first + last) * width)
                ratios.append(last)
                slopes.append(0.0)
                laws.append("cubic" if ramp else "line")
    note = (
        f"{len(moves)} linked moves in the order of the file are taken as one cycle over a link distance of {x[-1]:g}"
    )
    return make_table(x, y, ratios, slopes, law=tuple(laws), notes=(note,))


LAYOUT = Target(
    name="trio-linked-moves",
    title="Trio Motion Coordinator, MOVELINK and FLEXLINK calls",
    interpolation="ratios that rise and fall over the link axis straight, as half a cosine, or by polynomials of power 5, 7 or 9",
    law="line",
    spacing="free",
    max_points=2 * (_PARTS + 2) * MOST_MOVES + 1,
    evidence=(
        "MOVELINK and FLEXLINK: Trio's BASIC reference (ramps are distances or percentages of the link axis, shortened in proportion by "
        "MOVELINK where they are longer than it; the base distance of both is moved evenly throughout; the bits 10 to 12 of the options "
        "choose sine, power 9, 7 or 5 of the speed, or straight ramps). That a sine is half a cosine of the speed follows from the peak "
        "accelerations that the reference gives beside straight ramps: 1.55, 2.42, 2.16, 1.86, of which these curves have 1.571, 2.461, "
        "2.188, 1.875."
    ),
    read=read,
)
