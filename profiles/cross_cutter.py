"""The rotary cross-cutter's cam from three lengths alone (S2): the quintic return, and the cycle from cut to cut."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile, join

QUINTIC_RATIO = 7 / 15
"""Least mean ratio of a return in which the quintic does not reverse: ``K_0`` of S2, where its least ratio is zero."""

STAND_RATIO = 2 / 5
"""Greatest mean ratio of a return in which decelerating and accelerating as in S2 leave room to stand between them."""

_ROUNDING = 1e-12
# A mean ratio this near to one of the two above, as a part of it, is that one but for the rounding of its lengths.

_LEAST_ZONE = 1e-9
# Zones shorter than this part of the longer of circumference and cut length are lost in the rounding of positions.

_LEAST_RATIO = 1e-10
# Below this mean ratio the decelerating part of a return is lost in the rounding of positions.

_SHORTEST, _LONGEST = 1e-12, 1e12
# Lengths (m) whose fifth powers are numbers.

_LEAST_PART = 1e-6
# The shorter of circumference and cut length is at least this part of the longer.


def standstill(length: float, height: float) -> float:
    """Master travel (m) during which the slave stands still in `quintic_return`; the arguments are the same."""
    if not 0.0 < height < length * STAND_RATIO * (1 - _ROUNDING):
        return 0.0
    return length - 2.5 * height


def quintic_return(length: float, height: float) -> CamProfile:
    """Make the return of S2 over ``[0, length]``: from 0 to ``height``, ratio 1 and ratio slope 0 at both ends.

    With the mean ratio ``K = height / length`` and ``X = x / length`` the ratio is

    - ``K >= 7/15``: ``V = 1 + 30 (K - 1) X² (1 - X)²``, the quintic;
    - ``0 < K < 7/15``: ``V = (1 - u)² (1 + 2 u + q u²)`` with ``u`` from 0 to 1 in the decelerating part, then perhaps
      a standstill, then the mirror image. The mean of ``V`` is ``1/2 + q/30``, and it falls from 1 to 0 for every ``q``
      from -3 to -1. For ``K <= 2/5`` it is the curve of S2, ``q = -3``, in parts of ``5/4 height`` each. Between, where
      S2 defines no curve, the two parts fill the return and ``q = 30 K - 15``; at ``q = -1`` they make the quintic;
    - ``K <= 0``: the quintic; a slave that must come back has to reverse.

    Parameters
    ----------
    length
        Length of the return zone on the master (m).
    height
        Slave travel in the return zone (m).

    Raises
    ------
    InputError
        The length or the height is out of range.

    Examples
    --------
    >>> round(quintic_return(0.4, 0.2).extrema(order=1)[0].value, 12)
    0.0625
    """
    if not _SHORTEST <= length <= _LONGEST or not abs(height) <= _LONGEST:
        raise InputError(
            f"a return zone of {length!r} m with {height!r} m of slave travel: the return zone must be {_SHORTEST:g} m "
            f"to {_LONGEST:g} m long, and the travel {_LONGEST:g} m at most"
        )
    if 0.0 < height < length * _LEAST_RATIO:
        raise InputError(
            f"a return zone of {length!r} m with {height!r} m of slave travel: the slave would hardly move; "
            f"give it {length * _LEAST_RATIO!r} m or more to travel"
        )
    if height <= 0.0 or 15.0 * height >= 7.0 * length:
        return _quintic(length, height)
    stand = standstill(length, height)
    part = 1.25 * height if stand else 0.5 * length
    q = -3.0 if stand else 30.0 * height / length - 15.0
    half = 0.5 * height
    slow_down = _scaled([0.0, 1.0, 0.0, (q - 3.0) / 3.0, (1.0 - q) / 2.0, q / 5.0], part)
    speed_up = _scaled([0.0, 0.0, 0.0, (3.0 + q) / 3.0, -(1.0 + q) / 2.0, q / 5.0], part)
    speed_up[0] = half
    if not stand:
        return CamProfile.from_arrays([0.0, part, length], [slow_down, speed_up])
    return CamProfile.from_arrays([0.0, part, length - part, length], [slow_down, [half], speed_up])


def _quintic(length: float, height: float) -> CamProfile:
    """Make the straight line of ratio 1 plus the polynomial 3-4-5 that makes up for what it would miss."""
    d = height / length - 1.0
    return CamProfile.from_arrays([0.0, length], [_scaled([0.0, 1.0, 0.0, 10.0 * d, -15.0 * d, 6.0 * d], length)])


def _scaled(coefficients: list[float], length: float) -> list[float]:
    """Turn ``Y(X)`` into ``y(x) = length Y(x / length)``: S2's way from normalised to real values."""
    return [value * length ** (1 - power) for power, value in enumerate(coefficients)]


@dataclass(frozen=True)
class CrossCut:
    """One cut of the rotary cross-cutter of S2, programmed by three lengths.

    The cycle begins and ends at the cut: first half of the sync zone, return zone, second half.

    Parameters
    ----------
    circumference
        Circumference of the blade circle ``L_k`` (m).
    sync_zone
        Length of the sync zone ``L_s`` on the master (m), half of it at each end of the cycle.
    cut_length
        Cut length ``L_c`` (m).

    Raises
    ------
    InputError
        A length is out of range, or the sync zone leaves no return zone. All faults are told.

    Examples
    --------
    >>> cut = CrossCut(0.4, 0.2, 0.9)
    >>> cut.case, round(cut.standstill, 12), cut.completed, round(cut.cycle().advance, 12)
    (3, 0.2, False, 0.4)
    """

    circumference: float
    sync_zone: float
    cut_length: float

    def __post_init__(self) -> None:
        faults = self._bad_numbers() or self._bad_zones()
        if faults:
            raise InputError(*faults)

    def _bad_numbers(self) -> list[str]:
        """Tell which lengths are wrong in themselves."""
        named = (
            ("circumference", self.circumference),
            ("sync zone", self.sync_zone),
            ("cut length", self.cut_length),
        )
        return [
            f"{name} = {_mm(value)}: outside the range of lengths, {_SHORTEST:g} m to {_LONGEST:g} m; correct it"
            for name, value in named
            if not _SHORTEST <= value <= _LONGEST
        ]

    def _bad_zones(self) -> list[str]:
        """Tell which zones are too short to be there."""
        sync, longer = self.sync_zone, max(self.circumference, self.cut_length)
        least = longer * _LEAST_PART
        if min(self.circumference, self.cut_length) < least:
            short, long = ("cut length", "circumference") if self.case == 1 else ("circumference", "cut length")
            return [f"{short} below a millionth of the {long} of {_mm(longer)}; it must be {_mm(least)} at least"]
        margin = _LEAST_ZONE * longer
        faults = []
        # The limits that messages name lie one margin inside, so that they still work when typed as printed.
        if sync > self.circumference - margin:
            faults.append(
                f"sync zone = {_mm(sync)}: not below the circumference of {_mm(self.circumference)}, so the knife "
                f"would turn a whole turn in sync; shorten it to {_mm(self.circumference - 2 * margin)} at most"
            )
        if sync > self.cut_length - margin:
            faults.append(
                f"sync zone = {_mm(sync)}: not below the cut length of {_mm(self.cut_length)}, so no return zone is "
                f"left; shorten it to {_mm(self.cut_length - 2 * margin)} at most, or cut longer"
            )
        if sync < margin:
            faults.append(
                f"sync zone = {_mm(sync)}: below a billionth of {_mm(longer)}, the longer of circumference and cut "
                f"length; lengthen it to {_mm(2 * margin)} at least"
            )
        return faults

    @property
    def return_zone(self) -> float:
        """Length of the return zone on the master (m): ``Δx`` of S2."""
        return self.cut_length - self.sync_zone

    @property
    def return_height(self) -> float:
        """Knife travel in the return zone (m): ``Δy`` of S2."""
        return self.circumference - self.sync_zone

    @property
    def case(self) -> Literal[1, 2, 3]:
        """Case of S2: 1 the knife must run faster than the line, 2 neither, 3 slower."""
        if self.cut_length == self.circumference:
            return 2
        return 1 if self.cut_length < self.circumference else 3

    @property
    def critical_length(self) -> float:
        """Cut length above which the quintic would reverse: ``L_crit = (L_k - L_s) / K_0 + L_s`` (S2, m)."""
        return self.return_height * 15 / 7 + self.sync_zone

    @property
    def least_ratio(self) -> float:
        """Least ratio of the cycle: that of the quintic, ``1 + 15 (K - 1) / 8``, but at most 1 and at least 0."""
        mean = self.return_height / self.return_zone
        return min(1.0, max(0.0, 1.0 + 15.0 * (mean - 1.0) / 8.0))

    @property
    def standstill(self) -> float:
        """Length of material that passes while the knife stands still (m)."""
        return standstill(self.return_zone, self.return_height)

    @property
    def completed(self) -> bool:
        """Whether the cycle holds a completion because S2 defines no curve for this cut: ``2/5 < K < 7/15``."""
        mean = self.return_height / self.return_zone
        return STAND_RATIO * (1 + _ROUNDING) < mean < QUINTIC_RATIO * (1 - _ROUNDING)

    def cycle(self) -> CamProfile:
        """Make the cycle over the master period ``[0, L_c]``; the slave travels from 0 to ``L_k``."""
        if self.case == 2:
            return CamProfile.from_arrays([0.0, self.cut_length], [[0.0, 1.0]])
        half = 0.5 * self.sync_zone
        first = CamProfile.from_arrays([0.0, half], [[0.0, 1.0]])
        back = quintic_return(self.return_zone, self.return_height).shift(half, half)
        second = CamProfile.from_arrays([self.cut_length - half, self.cut_length], [[self.circumference - half, 1.0]])
        return join(first, back, second)


def _mm(value: float) -> str:
    """Write a length in millimetres."""
    return f"{value * 1e3:.10g} mm"
