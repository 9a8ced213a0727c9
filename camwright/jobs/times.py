"""What a job file writes as the time that a zone lasts, as length on the master."""

from __future__ import annotations

from camwright.jobs.fields import Known


def settle_times(known: Known) -> None:
    """Turn the zones that are known as times into lengths, ``l = v t``, once the line speed is known."""
    line_speed = known.numbers.get("cut.line_speed")
    if line_speed is not None:
        known.numbers.update({place: time * line_speed for place, time in known.indirect.times.items()})
