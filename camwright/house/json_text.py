"""JSON as every command prints and stores it."""

from __future__ import annotations

import json
from typing import Any


def to_json(answer: dict[str, Any]) -> str:
    """Write an answer as one JSON object on one line; NaN and infinity are refused, they must be null before."""
    return json.dumps(answer, allow_nan=False) + "\n"
