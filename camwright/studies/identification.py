"""The servo of a recorded trace: reading the trace, the answer, and the table for job files."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from camwright.house.files import read_bytes
from camwright.house.provenance import camwright_version
from camwright.profiles.errors import InputError
from camwright.profiles.tables.text import decode
from camwright.profiles.tables.trace_csv import read_trace_csv
from camwright.profiles.trace import Trace
from camwright.validation.identify.identification import Identified, identify

_MOST_BYTES = 1 << 24

PARAMETERS = {
    "bandwidth": ("bandwidth_rad_per_s", "ω", 1.0, "rad/s"),
    "damping": ("damping", "ζ", 1.0, ""),
    "position_gain": ("position_gain_per_s", "K", 1.0, "1/s"),
    "sample_time": ("sample_time_ms", "ΔT", 1e3, "ms"),
    "dead_time": ("dead_time_ms", "dead time", 1e3, "ms"),
    "velocity_feedforward": ("velocity_feedforward", "α", 1.0, ""),
}
"""JSON key, symbol, factor and unit of each parameter, by its name in `camwright.profiles.servo.Servo`."""

BEYOND = {
    "acceleration_feedforward": ("acceleration_feedforward_ms2", "β", 1e6, "ms^2"),
    "jerk_feedforward": ("jerk_feedforward_ms3", "γ", 1e9, "ms^3"),
}
"""As `PARAMETERS`: feed-forward that is told only where it is set or fitted."""

FIT = "fit"
"""What an option says whose value is to be found."""

ORIGINS = {
    "trace": "fitted to the trace",
    "assumed": "assumed: the trace allows it; if the drive is set otherwise, give --velocity-feedforward",
    "given": "given",
}


def read_trace(path: Path, columns: str | None = None) -> Trace:
    """Read a recorded trace, the columns as `read_trace_csv` takes them.

    Raises
    ------
    InputError
        The file cannot be read, or is no trace with equally spaced rows.
    """
    text = decode(read_bytes(path, "trace", _MOST_BYTES), str(path), _MOST_BYTES)
    return read_trace_csv(text, str(path), columns=columns)


_SUM = "# camwright identify, SHA-256 of the lines above: "


def identify_file(
    path: Path,
    velocity_feedforward: float | None,
    beyond: Mapping[str, float | None] | None = None,
    columns: str | None = None,
) -> tuple[Trace, Identified]:
    """Find the servo of a recorded trace.

    Parameters
    ----------
    velocity_feedforward
        Share of the command's velocity that is fed forward, if known.
    beyond
        As of `camwright.validation.identify.identification.identify`.
    columns
        As of `read_trace`.

    Raises
    ------
    InputError
        The trace cannot be used, or the share is not from 0 to 1.
    """
    if velocity_feedforward is not None and not 0.0 <= velocity_feedforward <= 1.0:
        raise InputError(f"--velocity-feedforward {velocity_feedforward:g}: it is a share from 0 to 1, usually 1")
    trace = read_trace(path, columns)
    return trace, identify(trace, str(path), velocity_feedforward, beyond)


def parameters_of(found: Identified) -> dict[str, tuple[str, str, float, str]]:
    """Parameters that are told of a servo: `PARAMETERS`, and what is fed forward beyond the velocity where it is set or fitted."""
    told = {name: each for name, each in BEYOND.items() if getattr(found.servo, name) or name in found.confidence}
    return {**PARAMETERS, **told}


def origin_of(found: Identified, name: str) -> str:
    """Say where a value comes from that was not fitted."""
    return ORIGINS["given" if name in BEYOND else found.feedforward_from]


def identify_answer(path: Path, trace: Trace, found: Identified, files: Sequence[Path]) -> dict[str, Any]:
    """Answer of ``camwright identify``."""
    scale, unit = residual_unit(trace)
    parameters = parameters_of(found)
    values = {key: getattr(found.servo, name) * factor for name, (key, _, factor, _) in parameters.items()}
    return {
        "file": str(path),
        **values,
        "velocity_feedforward_from": found.feedforward_from,
        "fit": found.fit,
        "residual_rms": {"value": found.residual * scale, "unit": unit},
        "confidence": {
            parameters[name][0]: [bound * parameters[name][2] for bound in bounds]
            for name, bounds in found.confidence.items()
        },
        "rows": found.rows,
        "notes": list(found.notes),
        "files": [str(file) for file in files],
    }


def servo_text(path: Path, trace: Trace, found: Identified) -> str:
    """Write the servo as the table of a job file, the confidence in comments."""
    scale, unit = residual_unit(trace)
    quality = f"fit {found.fit:.6f}, residual {found.residual * scale:.3g} {unit} rms over {found.rows} rows"
    lines = [
        f"# Identified from {one_line(path.name)} by camwright {camwright_version()}: {quality}.",
        "# Beside each value its range of 95 % confidence.",
        "[servo]",
    ]
    for name, (_, _, factor, written) in parameters_of(found).items():
        value, bounds = getattr(found.servo, name) * factor, found.confidence.get(name)
        spread = 0.0 if bounds is None else 0.5 * factor * (bounds[1] - bounds[0])
        number = rounded(value, spread)
        text = f'{name} = "{number} {written}"' if written else f"{name} = {number}"
        note = origin_of(found, name) if bounds is None else range_text(bounds, factor, written)
        lines.append(f"{text:40}# {note}")
    text = "\n".join(lines) + "\n"
    return f"{text}{_SUM}{hashlib.sha256(text.encode()).hexdigest()}\n"


def is_servo_text(data: bytes) -> bool:
    """Whether a file is what `servo_text` wrote, unchanged."""
    head, mark, digest = data.rpartition(_SUM.encode())
    return bool(mark) and digest.strip() == hashlib.sha256(head).hexdigest().encode()


def residual_unit(trace: Trace) -> tuple[float, str]:
    """Factor and unit of a residual as it is shown."""
    return (1e6, "um") if trace.unit == "m" else (1e6, "urad")


def rounded(value: float, spread: float) -> str:
    """Write a value to a hundredth of what it may be off, no more than 12 digits."""
    if not spread > 0.0:
        return repr(value)
    digits = max(0, 2 - math.floor(math.log10(spread)))
    return f"{round(value, digits):.{min(digits, 12)}f}"


def range_text(bounds: tuple[float, float], factor: float, unit: str) -> str:
    """Write a range with as many digits as tell its ends apart."""
    low, high = bounds[0] * factor, bounds[1] * factor
    spread = 0.5 * (high - low)
    return f"{rounded(low, spread)} to {rounded(high, spread)}{' ' + unit if unit else ''}"


def one_line(name: str) -> str:
    """Write a file's name so that it stays in its line."""
    return name if name.isprintable() else ascii(name)
