"""The phase of the sampling clock, where a trace shows it: the sample time is then known as by a vernier."""

from __future__ import annotations

import math

import numpy as np

from camwright.validation.identify.fit import (
    CONFIDENCE,
    ROUNDS,
    Minimum,
    TraceFit,
    moved,
    without,
)

_SEEN = 40.0
"""Gain of the fit from which on the clock counts as seen: squared residual over squared noise. The best of the thousands of teeth that
are tried gains about 20 where there is nothing to see."""

_CLOCKS = 4
"""Sampling phases tried, and parts of a sample by which the clock may be off at the end of the trace between two sample times tried."""

_MOST_TRIALS = 2000
_BEST_TEETH = 4

_REACHES = (0.01, 0.1)
"""Parts of the sample time by which the fit without clock may be off: little, and where the clock is seen plainly, which that fit takes
for the axis' own, much."""

_WHITE = 1.3
"""Squared residual over the squared noise of the rows up to which nothing else is looked for."""


def with_clock(fit: TraceFit, found: Minimum) -> Minimum:
    """Fit the clock too where the trace shows it."""
    mean = fit.residual(found.values, None)
    noise = found.cost / len(fit.times)
    if float(np.sum((fit.residual(found.values, 0.0) - mean) ** 2)) < _SEEN * noise:
        return found
    for reach in _REACHES:
        best, lead = _comb(fit, found, reach)
        if best.cost <= _WHITE * len(fit.times) * fit.noise**2:
            break
    noise = best.cost / len(fit.times)
    seen = found.cost - best.cost > _SEEN * noise and lead > CONFIDENCE**2 * (noise + fit.doubt(best))
    return best if seen else found


def _comb(fit: TraceFit, found: Minimum, reach: float) -> tuple[Minimum, float]:
    """Fit the clock, the sample time scanned so finely that no tooth of its comb is missed.

    Parameters
    ----------
    found
        The fit without clock.
    reach
        Part of the sample time by which it may be off.

    Returns
    -------
    (best, lead)
        The best fit, and by how much the best at another tooth is worse.
    """
    step, lasts = found.values["sample_time"], float(fit.times[-1] - fit.times[0])
    tooth = step * step / (_CLOCKS * lasts)
    teeth = min(math.ceil(reach * step / tooth), _MOST_TRIALS // (2 * _CLOCKS))
    names = tuple(name for name in found.names if name != "sample_time")
    thin = fit.thinned()
    others = thin.slopes(found.values, names, None)
    along = np.linalg.lstsq(others, -thin.slopes(found.values, ("sample_time",), None)[:, 0])[0]
    trials = []
    for number in range(-teeth, teeth + 1):
        values = {**found.values, "sample_time": step + number * tooth}
        by = math.log(values["sample_time"] / step)  # the others go along with the sample time
        values |= {name: moved(name, values[name], by * float(way)) for name, way in zip(names, along, strict=True)}
        for part in range(_CLOCKS):
            left = without(thin.residual(values, part / _CLOCKS), others.T)
            trials.append((float(left @ left), number, part / _CLOCKS, values))
    trials.sort(key=lambda trial: trial[0])
    chosen: list[tuple[float, int, float, dict[str, float]]] = []
    for trial in trials:
        if all(abs(trial[1] - other[1]) > _CLOCKS for other in chosen):  # teeth of its comb, each once
            chosen.append(trial)
        if len(chosen) == _BEST_TEETH:
            break
    fits = [fit.minimum(values, found.names, clock, ROUNDS) for _, _, clock, values in chosen]
    best, *others_best = sorted(fits, key=lambda each: each.cost)
    return best, min((other.cost for other in others_best), default=math.inf) - best.cost
