"""The motion laws: closed forms of their measures, and the sinusoidal ones against their published formulas."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from profiles.errors import InputError
from profiles.laws import LAWS, from_acceleration, law

FloatArray = NDArray[np.float64]
PI = math.pi

# peak velocity, peak acceleration and mean square of the acceleration of a motion of unit height in unit time
MEASURES: dict[str, tuple[float, float, float]] = {
    "cubic": (3 / 2, 6, 12),
    "velocity_trapezoid": (3 / 2, 9 / 2, 27 / 2),
    "modified_sine": (
        7 * PI / (4 + PI) / (5 * PI / (4 + PI)) * 1.2568619 if False else 4 * PI / (4 + PI) * 1.0,
        4 * PI**2 / (4 + PI),
        (4 * PI**2 / (4 + PI)) ** 2 / 2,
    ),
    "parabolic": (2, 4, 16),
    "poly_3_4_5": (15 / 8, 10 / math.sqrt(3), 120 / 7),
}
