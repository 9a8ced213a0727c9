"""Random outlines and a springback table for the proofs of bending programs."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from outlines import outline_of

from camwright.profiles.bender.outline import Outline
from camwright.profiles.bender.springback import Springback

MM = 1e-3


@pytest.fixture(scope="session")
def table() -> Springback:
    angles = np.radians([[0, 0], [15, 16.8], [20, 22.5], [45, 48.5], [90, 94.0], [135, 141], [170, 178]])
    radii = np.array([[0.5, 17.9], [5.5, 16.9], [6.0, 16.8], [20.0, 15.6], [1000.0, 14.6]])
    return Springback("test", *angles.T, radii[:, 0] * MM, np.radians(radii[:, 1]))


@pytest.fixture(scope="session")
def random_outline() -> Callable[[int], Outline]:
    """Outlines of 3 to 30 lines and arcs of both senses, 2 to 200 mm long; every second one is closed."""

    def make(seed: int) -> Outline:
        random = np.random.default_rng(seed)
        count = int(random.integers(3, 31))
        heading = np.cumsum(random.uniform(-2.2, 2.2, count))
        length = random.uniform(2.0, 200.0, count) * MM
        steps = length[:, None] * np.stack([np.cos(heading), np.sin(heading)], axis=1)
        points = np.vstack([[0.0, 0.0], np.cumsum(steps, axis=0)]) + random.uniform(-1, 1, 2)
        if seed % 2:
            points[-1] = points[0]
        bulges = np.where(random.random(count) < 0.5, random.uniform(-1.0, 1.0, count), 0.0)
        bulges[random.random(count) < 0.1] = math.tan(math.pi / 8)
        return outline_of(points, bulges)

    return make
