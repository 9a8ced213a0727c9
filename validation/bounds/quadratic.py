"""A convex quadratic programme by a primal-dual interior point (Mehrotra's predictor and corrector), for its multipliers."""

from __future__ import annotations

from typing import Any

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray

STEPS = 60
# Complementarity at which the multipliers are good enough; the step before has taken the residuals down with it.
ENOUGH = 1e-9
# Share of the way to the boundary that a step goes.
ASIDE = 0.99
# Least slack to start with, as a share of the room between two limits, its complementarity, and the least room that counts. From zero, with
# limits a million times what the motion needs, it took fifty steps where it takes seven from here.
START_ROOM, START, NARROW = 0.5, 0.1, 1e-9


def multipliers(
    weight: FloatArray, bottom: FloatArray, top: FloatArray, equations: Any, goal: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Multipliers of: minimise ``sum(weight x²) / 2`` where ``bottom <= x <= top`` and ``equations x = goal``.

    Parameters
    ----------
    weight
        Shape ``(n,)``, not negative.
    bottom, top
        Shape ``(n,)``, both infinite where there is no limit.
    equations, goal
        A sparse array of shape ``(k, n)``, independent rows; shape ``(k,)``.

    Returns
    -------
    (upper, lower, prices)
        Multipliers of the limits, not negative, zero where there is none, and of the equations: at the optimum
        ``weight x + upper - lower - equationsᵀ prices = 0``. Where the programme has no answer they are what the last step left.
    """
    from scipy.sparse import block_array, diags_array
    from scipy.sparse.linalg import splu

    limited = np.isfinite(top)
    low, high = bottom[limited], top[limited]
    across = equations.T.tocsc()

    # what meets the equations with the least weight, and least in shares of what the limits leave
    stiff, room = weight.copy(), np.maximum(high - low, NARROW)
    stiff[limited] += 1.0 / room**2
    counts = stiff != 0.0
    system = block_array([[diags_array(stiff), -across], [equations, None]], format="csc")
    own = system.indices == np.repeat(np.arange(system.shape[1]), np.diff(system.indptr))  # on the diagonal

    def factored(stiff: FloatArray) -> Any:
        """Factors of the system of a Newton step, of which nothing but the diagonal changes."""
        system.data[own] = stiff[counts]
        return splu(system)

    try:
        x, prices = np.split(factored(stiff).solve(np.concatenate([np.zeros(len(weight)), goal])), [len(weight)])
    except RuntimeError:  # singular
        x, prices = np.zeros(len(weight)), np.zeros(len(goal))
    slack = np.maximum(np.stack([high - x[limited], x[limited] - low]), START_ROOM * room)
    dual = START / slack
    for _ in range(STEPS):
        before = x, prices, slack, dual
        together = float((slack * dual).mean())
        if together < ENOUGH:
            break
        stiff = weight.copy()
        stiff[limited] += (dual / slack).sum(axis=0)
        try:
            factors = factored(stiff)
        except RuntimeError:  # singular: as far as double precision goes
            break
        open_ = np.stack([high - x[limited], x[limited] - low]) - slack
        left = across @ prices - weight * x
        left[limited] += dual[1] - dual[0]
        missing = goal - equations @ x

        def direction(
            change: FloatArray, open_: FloatArray = open_, left: FloatArray = left, missing: FloatArray = missing
        ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
            """Newton step towards products of slack and multiplier that change by the given amounts."""
            push = (change - dual * open_) / slack  # noqa: B023
            right = left.copy()
            right[limited] += push[1] - push[0]
            step = factors.solve(np.concatenate([right, missing]))  # noqa: B023
            moved = step[: len(weight)][limited]
            to_slack = open_ + np.stack([-moved, moved])
            return step[: len(weight)], step[len(weight) :], to_slack, (change - dual * to_slack) / slack  # noqa: B023

        with np.errstate(over="ignore", invalid="ignore"):  # of a system that is all but singular
            _, _, to_slack, to_dual = direction(-slack * dual)
            ahead = (slack + _step(slack, to_slack) * to_slack) * (dual + _step(dual, to_dual) * to_dual)
            centre = (float(ahead.mean()) / together) ** 3 * together
            to_x, to_prices, to_slack, to_dual = direction(centre - slack * dual - to_slack * to_dual)
            primal, adjoint = ASIDE * _step(slack, to_slack), ASIDE * _step(dual, to_dual)
            x, slack = x + primal * to_x, slack + primal * to_slack
            prices, dual = prices + adjoint * to_prices, dual + adjoint * to_dual
        if not all(np.isfinite(each).all() for each in (x, prices, slack, dual)):
            x, prices, slack, dual = before
            break
    upper, lower = np.zeros(len(weight)), np.zeros(len(weight))
    upper[limited], lower[limited] = dual
    return upper, lower, prices


def _step(value: FloatArray, change: FloatArray) -> float:
    """Greatest share of a change, at most all of it, that leaves everything positive."""
    falling = change < 0
    return min(1.0, float((-value[falling] / change[falling]).min(initial=np.inf)))
