"""How slow the machine is that the tests are run on: limits of processor time are multiples of a piece of work that is done beside."""

from __future__ import annotations

import time

_NOMINAL = 0.008
"""Processor time (s) of the piece of work where the limits were set."""


def _work() -> float:
    """Processor time (s) of a fixed piece of work, the least of three runs."""
    times = []
    for _ in range(3):
        begun, total = time.process_time(), 0
        for k in range(200_000):
            total += k % 7 * k
        times.append(time.process_time() - begun)
        assert total == 59_999_300_002
    return min(times)


def in_time(took: float, seconds: float) -> bool:
    """Whether a processor time (s) keeps a limit (s), or would where the limit was set: the machine's pace is asked where it decides."""
    return took < seconds or took < seconds * _work() / _NOMINAL
