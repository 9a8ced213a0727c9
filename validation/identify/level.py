"""Zeros of command and actual position that differ: whether a trace needs a constant between them."""

from __future__ import annotations

from dataclasses import replace

from camwright.validation.identify.fit import CONFIDENCE, ROUNDS, TraceFit

_WORTH = 10.0
"""Gain of the fit from which on a constant counts as there, in units of what one more parameter may gain by chance."""


def with_level(fit: TraceFit, velocity_feedforward: float | None) -> TraceFit:
    """Fit a constant between command and actual position too where the trace is not explained without.

    A lag looks like a constant as long as the speed is one; so it is left out unless the fit is clearly worse for it.
    """
    thin = fit.thinned()
    free = replace(thin, level=True)
    shares = (0.0, 1.0) if velocity_feedforward is None else (velocity_feedforward,)
    best = min((free.solve(share) for share in shares), key=lambda each: each.cost)
    without = min(
        (thin.minimum(best.values, best.names, None, ROUNDS), *(thin.solve(share) for share in shares)),
        key=lambda each: each.cost,
    )
    noise = best.cost / len(thin.times)
    gain = without.cost - best.cost
    return replace(fit, level=True) if gain > _WORTH * CONFIDENCE**2 * (noise + free.doubt(best)) else fit
