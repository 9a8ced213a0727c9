"""What all tests share: no display, and property tests that run the same way every time."""

from __future__ import annotations

import pytest
from hypothesis import settings

settings.register_profile("camwright", deadline=None, derandomize=True)
settings.load_profile("camwright")


@pytest.fixture(autouse=True)
def _no_display(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw figures without a display; read when matplotlib is first imported."""
    monkeypatch.setenv("MPLBACKEND", "Agg")
