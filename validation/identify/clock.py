"""The phase of the sampling clock, which nobody recorded: the fit over all that it may have been, by likelihood.

What the axis does beside its mean over all phases is a ripple at the sampling rate. Where the trace shows it the sample time is known as
by a vernier; where it does not, leaving it out moves the other parameters by more than the noise says. So the likelihood is summed over
phases and sample times, the other parameters following along: one sharp peak, a comb of some, or hardly a change, as it may be.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from camwright.profiles.halving import halved
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.servo import Servo
from camwright.validation.identify.fit import CONFIDENCE, ROUNDS, Minimum, TraceFit, coordinate, value_at, without
from camwright.validation.servo.sampled_axis import ComplexArray, ripple_response

_FAINT = 0.3
"""Squared ripple over the variance of the noise below which it moves nothing."""

_NODES = 9
"""Sample times at which the other parameters are fitted anew."""

_REACH = 4.5
"""Standard deviations of the sample time, as the fit without clock has it, that are looked at to both sides; the ripple adds its own."""

_WIDEST = 0.5
"""Part of the sample time beyond which nothing is looked at."""

_PHASES = 32
_FINEST = 0.02
_COARSEST = 0.125
"""Parts of a sample by which the clock may be off at the end of the trace between two sample times that are tried."""

_MOST_TRIALS = 6000
_CHUNK = 200
_KNOWN = 0.99
"""Likelihood within one tooth of the comb from which on the clock is known."""

_PLAIN = 30.0
"""Squared ripple over the variance of the noise from which on it may be worth to fit the clock from several teeth."""

_BEST_TEETH = 4
_LEAST = 1e-6
"""Likelihood of a trial, against the best, that is left out."""


@dataclass(frozen=True, eq=False)
class _Trials:
    """Sample times that were tried.

    Parameters
    ----------
    steps
        Sample times (s).
    costs
        Least squared residual over the phases, shape ``(n,)``.
    phases
        Phase at which it is least: part of a sample at the middle of the trace.
    weights
        Likelihood summed over the phases, its sum 1.
    centres, errors
        The other parameters' coordinates, mean over the phases, and their standard errors, shapes ``(n, others)``.
    """

    steps: FloatArray
    costs: FloatArray
    phases: FloatArray
    weights: FloatArray
    centres: FloatArray
    errors: FloatArray


def with_clock(fit: TraceFit, found: Minimum) -> Minimum:
    """Take the clock into account: fit it where the trace shows it, else sum over what it may have been.

    Parameters
    ----------
    found
        The fit without clock, the sample time among its parameters.

    Returns
    -------
    Minimum
        Its confidence holds what the command between the rows may do, too.
    """
    noise = _noise(fit, found)
    ripple = max(_ripple_energy(fit, found.values, phase) for phase in (0.0, 0.25, 0.5, 0.75))
    if ripple < _FAINT * noise:
        return _with_doubt(fit, found)
    trials = _tried(fit, found, ripple / noise, noise)
    tooth = found.values["sample_time"] ** 2 / float(fit.times[-1] - fit.times[0])
    best = int(trials.weights.argmax())
    near = np.abs(trials.steps - trials.steps[best]) < tooth
    unsure = float(trials.weights[near].sum()) < _KNOWN
    if unsure and ripple < _PLAIN * noise:
        return _summed(found, trials)
    teeth = _refined(fit, found, trials, tooth)  # what was tried is an approximation: a plain ripple is asked exactly
    known, noise = teeth[0], _noise(fit, teeth[0])
    close = [each for each in teeth if each.cost - known.cost < -2.0 * math.log(1.0 - _KNOWN) * noise]
    if known.cost > found.cost or (unsure and len(close) > 1):
        return _summed(found, trials)
    return _with_doubt(fit, known) if len(close) == 1 else _mixed(fit, close, noise)


def _with_doubt(fit: TraceFit, found: Minimum) -> Minimum:
    """Widen the confidence by what the command between the rows may do."""
    wider = math.sqrt(1.0 + fit.doubt(found) * len(fit.times) / found.cost)
    return found.widened(dict.fromkeys(found.names, wider))


def _noise(fit: TraceFit, found: Minimum) -> float:
    """Variance of a row, with what the command between the rows may do in any one direction."""
    return found.cost / (len(fit.times) - len(found.names) - 3) + fit.doubt(found)


def _ripple_energy(fit: TraceFit, values: dict[str, float], phase: float) -> float:
    """Squared ripple at a phase."""
    return float(np.sum((fit.residual(values, phase) - fit.residual(values, None)) ** 2))


def _tried(fit: TraceFit, found: Minimum, ripple: float, noise: float) -> _Trials:
    """Try sample times about that of the fit without clock, each at all phases."""
    others = tuple(name for name in found.names if name != "sample_time")
    middle, lasts = math.log(found.values["sample_time"]), float(fit.times[-1] - fit.times[0])
    # the standard error knows the noise of the rows alone; a ripple that was left out pushes by no more than all of it
    wider = math.sqrt(noise * len(fit.times) / found.cost)
    reach = min((_REACH + math.sqrt(ripple)) * wider * found.errors["sample_time"], _WIDEST)
    nodes = np.linspace(middle - reach, middle + reach, _NODES)
    ridge = _ridge(fit, found, others, nodes)
    step = found.values["sample_time"]
    fine = min(max(0.12 / math.sqrt(ripple), _FINEST), _COARSEST)
    count = min(2 * math.ceil(reach * lasts / (step * fine)) + 1, _MOST_TRIALS)
    steps = np.exp(np.linspace(middle - reach, middle + reach, max(count, _NODES)))
    slopes = fit.slopes(found.values, others, None)
    scale = np.sqrt((slopes**2).sum(axis=0))
    basis = _basis(fit, found, slopes / scale)
    shift = np.linalg.pinv(slopes / scale) / scale[:, None]
    doubt, rows = fit.doubt(found), len(fit.times) - len(found.names) - 4
    for _ in range(2):  # once more with the noise that the ripple leaves
        parts = [
            _of_chunk(fit, steps[k : k + _CHUNK], nodes, ridge, basis, shift, noise)
            for k in range(0, len(steps), _CHUNK)
        ]
        costs, phases, logs, centres, spread = (np.concatenate(each) for each in zip(*parts, strict=True))
        noise = min(noise, float(costs.min()) / rows + doubt)
    errors = np.sqrt(np.diag(np.linalg.pinv((slopes / scale).T @ (slopes / scale))) * noise) / scale
    weights = np.exp(logs - logs.max())
    return _Trials(steps, costs, phases, weights / weights.sum(), centres, np.sqrt(spread + errors**2))


def _ridge(
    fit: TraceFit, found: Minimum, others: Sequence[str], nodes: FloatArray
) -> tuple[FloatArray, FloatArray, ComplexArray]:
    """Fit the other parameters at some sample times, without clock: their coordinates, what is left, and the ripple's envelope."""
    places: list[FloatArray] = [np.empty(0)] * len(nodes)
    left: list[FloatArray] = [np.empty(0)] * len(nodes)
    ripples: list[ComplexArray] = [np.empty(0, dtype=np.complex128)] * len(nodes)
    half = len(nodes) // 2
    for way in (range(half, -1, -1), range(half, len(nodes))):
        values = found.values
        for node in way:
            step = math.exp(float(nodes[node]))
            values = fit.minimum({**values, "sample_time": step}, tuple(others), None, ROUNDS // 2).values
            places[node] = np.array([coordinate(name, values[name]) for name in others])
            left[node] = fit.residual(values, None)
            ripples[node] = _envelope(fit, Servo(**values))
    return np.stack(places), np.stack(left), np.stack(ripples)


def _envelope(fit: TraceFit, servo: Servo) -> ComplexArray:
    """Envelope of the ripple at the sampling rate, at the rows: the ripple is ``2 Re(envelope * exp(2 pi j (t - clock) / dT))``."""
    from scipy.fft import ifft

    rates = np.concatenate([fit.rates, -fit.rates[-2:0:-1]])
    spectrum = np.concatenate([fit.spectrum, np.conj(fit.spectrum[-2:0:-1])])
    return np.asarray(ifft(spectrum * ripple_response(servo, rates, 1))[fit.rows])


def _basis(fit: TraceFit, found: Minimum, slopes: FloatArray) -> FloatArray:
    """Orthonormal directions that the other parameters, the beginning and the level can move the axis in, shape ``(n, directions)``."""
    free = fit.free(Servo(**found.values))
    rows = [*(without(row, free) for row in slopes.T), *free]
    basis, sizes, _ = np.linalg.svd(np.stack(rows, axis=1) / np.linalg.norm(rows, axis=1), full_matrices=False)
    return np.asarray(basis[:, sizes > 1e-9 * sizes[0]])


def _of_chunk(
    fit: TraceFit,
    steps: FloatArray,
    nodes: FloatArray,
    ridge: tuple[FloatArray, FloatArray, ComplexArray],
    basis: FloatArray,
    shift: FloatArray,
    noise: float,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Costs, phases, log likelihoods, centres and their variance over the phases, of some sample times."""
    at = np.log(steps)
    places, left = _between(at, nodes, ridge[0]), _between(at, nodes, ridge[1])
    envelope = _between(at, nodes, ridge[2].real) + 1j * _between(at, nodes, ridge[2].imag)
    middle = 0.5 * float(fit.times[0] + fit.times[-1])
    ripple = 2.0 * envelope * np.exp(2j * math.pi * (fit.times - middle) / steps[:, None])
    sides = np.stack([left, ripple.real, ripple.imag], axis=1)  # residual = left - cos * real - sin * imag
    apart = sides - (sides @ basis) @ basis.T
    gram = apart @ apart.transpose(0, 2, 1)
    angle = 2.0 * math.pi * np.arange(_PHASES) / _PHASES
    mix = np.stack([np.ones(_PHASES), -np.cos(angle), -np.sin(angle)])
    costs = np.einsum("ip,nij,jp->np", mix, gram, mix)
    logs = -0.5 * costs / noise
    top = logs.max(axis=1)
    share = np.exp(logs - top[:, None])
    total = share.sum(axis=1)
    share /= total[:, None]
    # what the ripple pushes the other parameters by: the residual is their slopes times minus that push
    moves = -np.einsum("kn,min,ip->mpk", shift, sides, mix)
    centre = np.einsum("mp,mpk->mk", share, moves)
    spread = np.einsum("mp,mpk->mk", share, (moves - centre[:, None]) ** 2)
    phases = angle[costs.argmin(axis=1)] / (2.0 * math.pi)
    return costs.min(axis=1), phases, top + np.log(total), places + centre, spread


def _between(at: FloatArray, nodes: FloatArray, values: FloatArray) -> FloatArray:
    """Parabolas through the three nearest of equally spaced nodes."""
    width = float(nodes[1] - nodes[0])
    first = np.clip(np.round((at - nodes[0]) / width).astype(np.intp) - 1, 0, len(nodes) - 3)
    part = ((at - nodes[first]) / width)[:, None]
    below, middle, above = values[first], values[first + 1], values[first + 2]
    return np.asarray(
        below * (0.5 * (part - 1.0) * (part - 2.0))
        - middle * (part * (part - 2.0))
        + above * (0.5 * part * (part - 1.0))
    )


def _refined(fit: TraceFit, found: Minimum, trials: _Trials, tooth: float) -> list[Minimum]:
    """Fit the clock too, from the best sample times of which no two belong to one tooth; the best first."""
    chosen: list[int] = []
    for trial in np.argsort(trials.costs).tolist():
        if all(abs(trials.steps[trial] - trials.steps[other]) > 0.75 * tooth for other in chosen):
            chosen.append(trial)
        if len(chosen) == _BEST_TEETH:
            break
    names = [name for name in found.names if name != "sample_time"]
    half = 0.5 * float(fit.times[-1] - fit.times[0])
    fits = []
    for trial in chosen:
        step = float(trials.steps[trial])
        values = {**found.values, "sample_time": step}
        values |= {name: value_at(name, float(at)) for name, at in zip(names, trials.centres[trial], strict=True)}
        # the phase counts from the middle of the trace, the clock from its first row
        fits.append(fit.minimum(values, found.names, float((half / step + trials.phases[trial]) % 1.0), ROUNDS))
    return sorted(fits, key=lambda each: each.cost)


def _mixed(fit: TraceFit, teeth: list[Minimum], noise: float) -> Minimum:
    """Mix the fits of some teeth, none of which the trace rules out, by their likelihood: the best fit, with the 95 % of them all."""
    best = teeth[0]
    weights = np.exp([-0.5 * (each.cost - best.cost) / noise for each in teeth])
    weights /= weights.sum()
    sure = [_with_doubt(fit, each) for each in teeth]
    errors, bounds = {}, {}
    for name in best.names:
        centres = np.array([coordinate(name, each.values[name]) for each in sure])
        widths = np.array([each.errors[name] for each in sure])
        middle = coordinate(name, best.values[name])
        errors[name] = math.sqrt(float(weights @ (widths**2 + (centres - middle) ** 2)))
        low, high = (_quantile(weights, centres, widths, share) for share in (0.025, 0.975))
        bounds[name] = (value_at(name, low), value_at(name, high))
    return replace(best, errors=errors, bounds=bounds)


def _summed(found: Minimum, trials: _Trials) -> Minimum:
    """Sum the likelihood up: the mean and the 95 % of each parameter."""
    some = trials.weights > _LEAST * trials.weights.max()
    weights = trials.weights[some] / trials.weights[some].sum()
    others = [name for name in found.names if name != "sample_time"]
    gap = float(np.log(trials.steps[1] / trials.steps[0]))
    known = {"sample_time": (np.log(trials.steps[some]), np.full(int(some.sum()), gap))}
    known |= {name: (trials.centres[some, k], trials.errors[some, k]) for k, name in enumerate(others)}
    values, errors, bounds = dict(found.values), {}, {}
    for name, (centres, widths) in known.items():
        mean = float(weights @ centres)
        values[name] = value_at(name, mean)
        errors[name] = math.sqrt(float(weights @ (widths**2 + (centres - mean) ** 2)))
        low, high = (_quantile(weights, centres, widths, share) for share in (0.025, 0.975))
        bounds[name] = (value_at(name, low), value_at(name, high))
    return replace(found, values=values, cost=float(trials.costs.min()), errors=errors, bounds=bounds)


def _quantile(weights: FloatArray, centres: FloatArray, widths: FloatArray, share: float) -> float:
    """Quantile of a mixture of normal distributions, by bisection."""
    from scipy.special import ndtr

    low = float((centres - 2.0 * CONFIDENCE * widths).min() - 1e-12)
    high = float((centres + 2.0 * CONFIDENCE * widths).max() + 1e-12)
    ends = halved(lambda at: float(weights @ ndtr((at - centres) / widths)) < share, low, high, most=60)
    return 0.5 * sum(ends)
