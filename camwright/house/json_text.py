"""JSON as every command prints and stores it."""

from __future__ import annotations

import json
import math
from json.encoder import encode_basestring_ascii
from typing import Any

_encoded = json.JSONEncoder(allow_nan=False).encode


def to_json(answer: dict[str, Any]) -> str:
    """Write an answer as one JSON object on one line; NaN and infinity are refused, they must be null before."""
    return json.dumps(answer, allow_nan=False) + "\n"


def to_lines(value: Any, depth: int = 0) -> str:
    """Write what `json.dumps` does with an indent of one, which is slow: it makes every number a step of its own; not of NaN or infinity.

    Examples
    --------
    >>> data = {"a": [1.5, (2, 0.1)], "b": {"c": "µ", "d": []}, "e": None, "f": {}}
    >>> to_lines(data) == json.dumps(data, indent=1)
    True
    """
    begin, end = "\n" + " " * (depth + 1), "\n" + " " * depth
    if isinstance(value, dict) and value:
        entries = (f"{encode_basestring_ascii(key)}: {to_lines(entry, depth + 1)}" for key, entry in value.items())
        return "{" + begin + f",{begin}".join(entries) + end + "}"
    if isinstance(value, list | tuple) and value:
        return "[" + begin + f",{begin}".join(to_lines(entry, depth + 1) for entry in value) + end + "]"
    if isinstance(value, float) and math.isfinite(value):
        return float.__repr__(value)
    return encode_basestring_ascii(value) if isinstance(value, str) else _encoded(value)
