"""How far a carriage must run beyond its sync zone to be back in time, in closed form but for one number.

A carriage leaves the sync zone at a velocity ``v``, turns round, runs back behind the zone, turns again and meets it at ``v``. Its motion
mirrored about the middle of the return is a motion too, and so is the mean of the two, which overshoots neither end further than they
do: only symmetric motions need to be looked at. Let ``a`` be the acceleration at which the carriage turns, zero or backwards. The way to
the turn that takes least time and least length is braking with the greatest jerk, the acceleration held, and jerk the other way until
``a``; the harder the turn, the shorter it is. From turn to turn the distances that can be covered are an interval
(`camwright.profiles.closed_forms.transfer`). So the hardest turn from which the way back fits into that interval needs the least overshoot.

Between the turns the carriage runs backwards or stands. Only where it would come back too far even so does it run forwards in between, as
slowly as will do.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from camwright.profiles.closed_forms.transfer import (
    Bounds,
    State,
    Transfer,
    farthest,
    nearest,
)
from camwright.profiles.halving import halved

TURNS = 24
"""Turns looked at first, evenly from the hardest to a full stop."""
_BISECTIONS = 60
_ROUNDING = 1e-12


@dataclass(frozen=True)
class Overshoot:
    """A symmetric return that overshoots least.

    Parameters
    ----------
    distance
        Overshoot beyond either end of the sync zone, a magnitude.
    braking
        The way from the end of the sync zone to the turn.
    back
        From turn to turn, with the least and with the greatest distance that it can cover backwards.
    share
        Share of the former in the mean of the two that covers the way back.
    """

    distance: float
    braking: Transfer
    back: tuple[Transfer, Transfer]
    share: float


def least_overshoot(time: float, velocity: float, way: float, bounds: Bounds, enough: float = 0.0) -> Overshoot | None:
    """Find the return that overshoots least; None if the limits do not let the carriage be back in time.

    Parameters
    ----------
    time
        Duration of the return.
    velocity
        Velocity at both ends, positive.
    way
        Way back, a magnitude: the return ends that far behind its start.
    bounds
        Limits; the least velocity is negative.
    enough
        Overshoot at which the search ends: any return that overshoots no further will do.
    """
    ends = State(velocity, 0.0)
    quickest = nearest(time, ends, ends, bounds)
    if quickest is None or quickest.distance > -way:
        return None
    hardest = _hardest(velocity, bounds)

    def at(share: float) -> Overshoot | None:
        return _with_turn(time, velocity, way, bounds, share * hardest)

    found, good, bad = at(1.0), 1.0, 1.0
    if (
        found is None
    ):  # as the quickest way back turns: near the end of what is possible no turn is much harder or softer
        good = min(max(-next((turn for _, turn in quickest.turns()), 0.0), 0.0) / hardest, 1.0)
        found = at(good)
    if found is None:
        good = 1.0
    while found is None and good > 0.5 / TURNS:
        good, bad = good - 1.0 / TURNS, good
        found = at(max(good, 0.0))
    for _ in range(_BISECTIONS):
        middle = 0.5 * (good + bad)
        if found is None or found.distance <= enough or middle in (good, bad):
            break
        here = at(middle)
        if here is None:
            bad = middle
        else:
            good, found = middle, here
    return found


def shortest_stop(velocity: float, bounds: Bounds) -> float:
    """Distance within which a carriage turns that brakes as hard as it may: no return overshoots less."""
    return _braking(velocity, _hardest(velocity, bounds), bounds).distance


def _hardest(velocity: float, bounds: Bounds) -> float:
    """Greatest deceleration at which a carriage can turn."""
    return min(bounds.acceleration, math.sqrt(2 * bounds.jerk * velocity))


def _with_turn(time: float, velocity: float, way: float, bounds: Bounds, turn: float) -> Overshoot | None:
    """Return that turns with a given deceleration; None if that does not bring the carriage back in time."""
    braking = _braking(velocity, turn, bounds)
    out = braking.distance
    rest = time - 2 * braking.time
    if rest <= 0:
        return None
    start, end = State(0.0, -turn), State(0.0, turn)
    backwards = Bounds(bounds.least_velocity, 0.0, bounds.acceleration, bounds.jerk)
    far, near = nearest(rest, start, end, backwards), farthest(rest, start, end, backwards)
    if far is None or near is None:
        return None
    needed = -(way + 2 * out)
    if needed < far.distance * (1 + _ROUNDING):
        return None
    if needed > near.distance:
        forwards = _forwards(rest, start, end, bounds, needed)
        return None if forwards is None else Overshoot(out, braking, (forwards, forwards), 1.0)
    span = near.distance - far.distance
    return Overshoot(out, braking, (near, far), max((needed - far.distance) / span, 0.0) if span > 0 else 1.0)


def _forwards(time: float, start: State, end: State, bounds: Bounds, needed: float) -> Transfer | None:
    """Way from turn to turn that goes back and some way forwards again; None if no such way stays between the turns."""

    def within(top: float) -> Transfer | None:
        found = farthest(time, start, end, replace(bounds, greatest_velocity=top))
        return None if found is None or found.distance < needed else found

    if within(bounds.greatest_velocity) is None:
        return None
    found = within(halved(lambda top: within(top) is not None, bounds.greatest_velocity, 0.0, most=_BISECTIONS)[0])
    room = _ROUNDING * abs(needed)
    return None if found is None or found.reach()[1] > room or found.reach()[0] < needed - room else found


def _braking(velocity: float, turn: float, bounds: Bounds) -> Transfer:
    """Quickest and shortest way from a velocity without acceleration to a standstill with a given deceleration."""
    j, a_max = bounds.jerk, bounds.acceleration
    deepest = math.sqrt(j * velocity + 0.5 * turn * turn)
    hold = 0.0
    if deepest > a_max:
        deepest = a_max
        hold = (velocity - (a_max**2 - 0.5 * turn**2) / j) / a_max
    deepest = max(deepest, turn)
    return Transfer(State(velocity, 0.0), ((deepest / j, -j), (hold, 0.0), ((deepest - turn) / j, j)))
