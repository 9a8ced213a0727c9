"""What an answer says of the line speeds at which a cam is released."""

from __future__ import annotations

from typing import Any

from camwright.studies.speed_band import SpeedBand


def band_answer(band: SpeedBand) -> dict[str, Any]:
    """Write a band: its parts in m/s, and what binds at the lower and the upper end of each in turn; of no band what forbids it."""
    binds = [name for pair in band.binds for name in pair] if band.parts else list(band.forbids)
    return {"speed_band": [list(part) for part in band.parts], "speed_band_binds": binds}
