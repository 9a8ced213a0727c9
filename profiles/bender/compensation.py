"""From bend plan to NC program: springback added, and three decimals whose rounding does not add up along the rule."""

from __future__ import annotations

import math

import numpy as np

from camwright.profiles.bender.plan import BendPlan
from camwright.profiles.bender.program import NcProgram
from camwright.profiles.bender.springback import Springback

_EASING = 0.01
"""Length (m) over which a sideways error is taken out: on shorter sides a full correction would twist the outline."""

_NOTICED = 1e-6
"""Sideways error at the far end of a side (m) that is worth moving its near end for."""


def compensate(plan: BendPlan, springback: Springback, name: str) -> NcProgram:
    """Write the bends in the numbers of the program, steering the rule along the outline.

    A virtual rule is bent while the program is written. Each feed is chosen from where the rounded program has
    brought the rule, so that it reaches the next bend; each mould angle so that the next side, from where it really
    begins, points at its end. What remains is the rounding of one feed and one angle: half a thousandth of a
    millimetre, and half a thousandth of a degree over the length of one side. For that second part the bend is moved
    along the side before it, so that both ends of the side share the error.

    Parameters
    ----------
    springback
        The tables; `Springback.faults` should be empty for this plan.
    """
    factors = springback.by_radius(plan.radii).tolist()
    places = plan.vertices.tolist()
    sides = plan.feeds.tolist()
    x, y = places[0]
    heading = plan.heading
    feeds, bends = [], []
    for k, factor in enumerate(factors):
        (at_x, at_y), (to_x, to_y), side = places[k + 1], places[k + 2], sides[k + 1]
        ux, uy = math.cos(heading), math.sin(heading)
        feed = (at_x - x) * ux + (at_y - y) * uy
        bx, by = x + feed * ux, y + feed * uy
        # direction of the next side, turned so that the sideways error is gone at its end (or after the easing length)
        nx, ny = (to_x - at_x) / side, (to_y - at_y) / side
        off = nx * (by - at_y) - ny * (bx - at_x)
        wanted = math.atan2(ny, nx) - off / max(side, _EASING) - heading
        wanted = math.remainder(wanted, 2 * math.pi)
        bend = _thousandths(math.degrees(springback.mould_angle(wanted, factor)))
        turn = springback.workpiece_angle(math.radians(bend / 1e3), factor)
        heading += turn
        vx, vy = math.cos(heading), math.sin(heading)
        miss = vx * (to_y - by) - vy * (to_x - bx)
        across = vx * uy - vy * ux  # how far a longer feed moves the next side to its left
        if side > _EASING and abs(miss) > _NOTICED and abs(across) > 0.25:
            feed += math.copysign(miss / (1 + abs(across)), miss * across)
        step = max(0, round(feed * 1e6))
        x, y = x + step * 1e-6 * ux, y + step * 1e-6 * uy
        feeds.append(step)
        bends.append(bend)
    end_x, end_y = places[-1]
    last = (end_x - x) * math.cos(heading) + (end_y - y) * math.sin(heading)
    feeds.append(max(0, round(last * 1e6)))
    return NcProgram(name, np.array(feeds, dtype=np.int64), np.array(bends, dtype=np.int64))


def _thousandths(degrees: float) -> int:
    return round(degrees * 1e3) or (1 if degrees >= 0 else -1)  # a bend of zero is no bend
