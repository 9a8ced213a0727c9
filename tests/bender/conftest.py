"""Drawings for the bender's tests."""

from collections.abc import Callable
from pathlib import Path

import ezdxf
import pytest


@pytest.fixture
def drawing(tmp_path: Path) -> Callable[..., Path]:
    """Make a DXF file: ``drawing(draw, units=4)`` calls ``draw(modelspace, document)`` and gives the path."""

    def make(draw: Callable[..., None], units: int = 4, name: str = "drawing.dxf", version: str = "R2000") -> Path:
        document = ezdxf.new(version, units=units)
        draw(document.modelspace(), document)
        document.saveas(tmp_path / name)
        return tmp_path / name

    return make
