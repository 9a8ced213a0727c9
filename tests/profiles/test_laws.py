"""The motion laws: closed forms of their measures, and the sinusoidal ones against their published formulas."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from camwright.profiles.errors import InputError
from camwright.profiles.laws import LAWS, from_acceleration, law
from camwright.profiles.returns import law_return

FloatArray = NDArray[np.float64]
PI = math.pi
PEAK_MODIFIED_SINE = 4 * PI**2 / (4 + PI)
PEAK_MODIFIED_TRAPEZOID = 8 * PI / (2 + PI)

# peak velocity, peak acceleration and mean square of the acceleration of a motion of unit height in unit time
MEASURES: dict[str, tuple[float, float, float]] = {
    "linear": (1, 0, 0),
    "parabolic": (2, 4, 16),
    "cubic": (3 / 2, 6, 12),
    "velocity_trapezoid": (3 / 2, 9 / 2, 27 / 2),
    "acceleration_trapezoid": (2, 16 / 3, (16 / 3) ** 2 * 2 / 3),
    "double_s": (3 / 2, 6, 16),
    "cycloid": (2, 2 * PI, 2 * PI**2),
    "modified_trapezoid": (2, PEAK_MODIFIED_TRAPEZOID, PEAK_MODIFIED_TRAPEZOID**2 * 3 / 4),
    "modified_sine": (4 * PI / (4 + PI), PEAK_MODIFIED_SINE, PEAK_MODIFIED_SINE**2 / 2),
    "poly_3_4_5": (15 / 8, 10 / math.sqrt(3), 120 / 7),
    "poly_4_5_6_7": (35 / 16, 84 / (5 * math.sqrt(5)), 280 / 11),
}

# peak jerk, where the acceleration does not jump
JERKS: dict[str, float] = {
    "acceleration_trapezoid": 8 * 16 / 3,
    "double_s": 72,
    "cycloid": 4 * PI**2,
    "modified_trapezoid": 4 * PI * PEAK_MODIFIED_TRAPEZOID,
    "modified_sine": 4 * PI * PEAK_MODIFIED_SINE,
    "poly_3_4_5": 60,
    "poly_4_5_6_7": 105 / 2,
}

# highest derivative that does not jump, the rests before and after included
SMOOTH: dict[str, int] = {
    "linear": 0,
    "parabolic": 1,
    "cubic": 1,
    "velocity_trapezoid": 1,
    "acceleration_trapezoid": 2,
    "double_s": 2,
    "cycloid": 2,
    "modified_trapezoid": 2,
    "modified_sine": 2,
    "poly_3_4_5": 2,
    "poly_4_5_6_7": 3,
}


def test_every_law_has_its_closed_forms_here() -> None:
    assert set(MEASURES) == set(LAWS) == set(SMOOTH)
    assert set(JERKS) == {name for name, order in SMOOTH.items() if order >= 2}


@pytest.mark.parametrize("name", LAWS)
def test_peaks_and_mean_square_are_the_closed_forms(name: str) -> None:
    velocity, acceleration, mean_square = MEASURES[name]
    motion = law(name)
    assert motion.extrema(1)[1].value == pytest.approx(velocity, rel=1e-13)
    low, high = motion.extrema(2)
    assert high.value == pytest.approx(acceleration, rel=1e-13, abs=1e-15)
    assert low.value == pytest.approx(-acceleration, rel=1e-12, abs=1e-15)
    assert motion.mean_square(2) == pytest.approx(mean_square, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("name", JERKS)
def test_peak_jerk_is_the_closed_form(name: str) -> None:
    low, high = law(name).extrema(3)
    assert max(-low.value, high.value) == pytest.approx(JERKS[name], rel=1e-12)


@pytest.mark.parametrize(
    ("name", "rms", "against_quintic"),
    [
        ("cubic", 3.4641, -16.3),
        ("velocity_trapezoid", 3.6742, -11.3),
        ("modified_sine", 3.9089, -5.6),
        ("parabolic", 4.0000, -3.4),
        ("poly_3_4_5", 4.1404, 0.0),
        ("modified_trapezoid", 4.2332, 2.2),
        ("cycloid", 4.4429, 7.3),
        ("poly_4_5_6_7", 5.0452, 21.9),
    ],
)
def test_rms_acceleration_is_that_of_the_literature(name: str, rms: float, against_quintic: float) -> None:
    value = math.sqrt(law(name).mean_square(2))
    assert value == pytest.approx(rms, abs=5e-5)
    quintic = math.sqrt(law("poly_3_4_5").mean_square(2))
    assert 100 * (value / quintic - 1) == pytest.approx(against_quintic, abs=0.05)


@pytest.mark.parametrize("name", [name for name in LAWS if name != "linear"])
def test_longest_zone_without_reversal(name: str) -> None:
    """The return's least ratio ``1 - V (1 - height / length)`` is zero at the length ``height V / (V - 1)``."""
    velocity, height = MEASURES[name][0], 0.3
    longest = height * velocity / (velocity - 1)
    assert law_return(name, longest, height).extrema(1)[0].value == pytest.approx(0.0, abs=1e-12)
    assert law_return(name, 1.001 * longest, height).extrema(1)[0].value < -1e-4
    assert law_return(name, 0.999 * longest, height).extrema(1)[0].value > 1e-4


@pytest.mark.parametrize("name", LAWS)
def test_runs_from_rest_at_zero_to_rest_at_one(name: str) -> None:
    motion = law(name)
    assert (motion.start, motion.end) == (0.0, 1.0)
    assert float(motion(0.0)) == 0.0
    assert float(motion(1.0)) == pytest.approx(1.0, abs=1e-14)
    for order in range(1, SMOOTH[name] + 1):
        assert float(motion(0.0, order)) == 0.0
        assert float(motion(1.0, order)) == pytest.approx(0.0, abs=1e-11)


@pytest.mark.parametrize("name", LAWS)
def test_smoothness_is_as_stated_and_no_more(name: str) -> None:
    motion = law(name)
    for order in range(SMOOTH[name] + 1):
        assert np.abs(motion.jumps(order, seam=False)).max(initial=0.0) <= 1e-12
    beyond = SMOOTH[name] + 1
    ends = [abs(float(motion(0.0, beyond))), abs(float(motion(1.0, beyond)))]
    assert max([*np.abs(motion.jumps(beyond, seam=False)), *ends]) >= 1.0


@pytest.mark.parametrize("name", LAWS)
def test_mirror_symmetry(name: str) -> None:
    motion, x = law(name), np.linspace(0.0, 1.0, 1001)
    assert np.abs(motion(x) + motion(1.0 - x) - 1.0).max() <= 1e-13
    inner = x[np.abs(x[:, None] - motion.breaks[None, :]).min(axis=1) > 1e-9]
    assert np.abs(motion(inner, 1) - motion(1.0 - inner, 1)).max() <= 1e-12
    assert np.abs(motion(inner, 2) + motion(1.0 - inner, 2)).max() <= 1e-11


def cycloid(x: FloatArray) -> FloatArray:
    """``s = x - sin(2 pi x) / (2 pi)``."""
    return np.asarray(x - np.sin(2 * PI * x) / (2 * PI))


def modified_sine(x: FloatArray) -> FloatArray:
    """As printed in the handbooks, with ``pi + 4`` below and three branches."""
    first = PI / (4 + PI) * (x - np.sin(4 * PI * x) / (4 * PI))
    middle = (2 + PI * x - 9 / 4 * np.sin(4 * PI * x / 3 + PI / 3)) / (4 + PI)
    last = (4 + PI * x - np.sin(4 * PI * x) / 4) / (4 + PI)
    return np.select([x < 1 / 8, x <= 7 / 8], [first, middle], last)


def modified_trapezoid(x: FloatArray) -> FloatArray:
    """As printed in the handbooks up to the middle; the rest by symmetry."""
    z = np.minimum(x, 1.0 - x)
    first = 2 * z - np.sin(4 * PI * z) / (2 * PI)
    second = 1 / 4 - 1 / (2 * PI) + 4 * PI * (z**2 - z / 4 + 1 / 64) + 2 * (z - 1 / 8)
    third = -PI / 2 + 2 * (1 + PI) * z - np.sin(4 * PI * (z - 1 / 4)) / (2 * PI)
    half = np.select([z < 1 / 8, z <= 3 / 8], [first, second], third) / (2 + PI)
    return np.where(x <= 0.5, half, 1.0 - half)


@pytest.mark.parametrize(
    ("name", "formula"),
    [("cycloid", cycloid), ("modified_sine", modified_sine), ("modified_trapezoid", modified_trapezoid)],
)
def test_sinusoids_are_their_formulas(name: str, formula: Callable[[FloatArray], FloatArray]) -> None:
    x = np.linspace(0.0, 1.0, 5001)
    assert np.abs(law(name)(x) - formula(x)).max() <= 1e-13


@pytest.mark.parametrize(
    ("name", "coefficients"),
    [
        ("linear", [0, 1]),
        ("cubic", [0, 0, 3, -2]),
        ("poly_3_4_5", [0, 0, 0, 10, -15, 6]),
        ("poly_4_5_6_7", [0, 0, 0, 0, 35, -84, 70, -20]),
    ],
)
def test_polynomials_are_their_formulas(name: str, coefficients: list[float]) -> None:
    x = np.linspace(0.0, 1.0, 1001)
    assert np.abs(law(name)(x) - np.polynomial.polynomial.polyval(x, coefficients)).max() <= 1e-15


def test_motion_from_an_acceleration_is_scaled_and_leaves_empty_pieces_out() -> None:
    motion = from_acceleration([2.0, 0.0, 4.0, 2.0], [0.0, 3.0, 3.0, -3.0, 0.0])
    assert motion.pieces == 3
    assert motion.breaks.tolist() == [0.0, 0.25, 0.75, 1.0]
    assert float(motion(1.0)) == pytest.approx(1.0, abs=1e-15)
    # four equal jerk phases: 32 D/T³ and 8 D/T²
    assert motion.extrema(3)[1].value == pytest.approx(32.0, rel=1e-14)
    assert motion.extrema(2)[1].value == pytest.approx(8.0, rel=1e-14)


def test_laws_name_themselves_and_their_source() -> None:
    for name, entry in LAWS.items():
        assert entry.name == name
        assert entry.title
        assert entry.source


def test_unknown_law_is_refused() -> None:
    with pytest.raises(InputError, match=r"no motion law 'quintic'; the laws are linear, parabolic, .*poly_4_5_6_7"):
        law("quintic")
