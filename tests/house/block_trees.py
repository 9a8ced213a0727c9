"""Drawings whose blocks hold blocks."""

from ezdxf.document import Drawing
from ezdxf.layouts import Modelspace


def nested(m: Modelspace, d: Drawing) -> None:
    """Draw blocks in blocks, deeper than is read."""
    for i in range(12):
        block = d.blocks.new(f"B{i}")
        if i:
            block.add_blockref(f"B{i - 1}", (0, 0))
        else:
            block.add_line((0, 0), (1, 0))
    m.add_blockref("B11", (0, 0))


def wide(m: Modelspace, d: Drawing) -> None:
    """Draw few blocks that unfold to ten million lines."""
    for i in range(7):
        block = d.blocks.new(f"B{i}")
        for k in range(10):
            if i:
                block.add_blockref(f"B{i - 1}", (k, 0))
            else:
                block.add_line((k, 0), (k + 1, 0))
    m.add_blockref("B6", (0, 0))
