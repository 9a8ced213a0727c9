"""The rotary knife: blades on a drum that turns one way, its edge moving with the material during the cut."""

from __future__ import annotations

from dataclasses import dataclass

from profiles.cycle import Cut
from profiles.polynomial import CamProfile


@dataclass(frozen=True)
class RotaryKnife:
    """A rotary knife in sync by its circumferential speed (S1).

    The slave position ``y`` is the travel of the blade's edge along the circumference (m).

    Parameters
    ----------
    circumference
        Circumference of the blade circle ``y_c`` (m).
    """

    circumference: float

    @property
    def pitch(self) -> float:
        """Slave travel per cycle (m)."""
        return self.circumference

    def sync_profile(self, cut: Cut) -> CamProfile:
        """Slave in the sync zone, from master and slave zero: ``y = x`` (``k = 1``), over ``[0, l_s]``."""
        return CamProfile.from_arrays([0.0, cut.sync_zone], [[0.0, 1.0]])
