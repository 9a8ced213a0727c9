"""Writing pictures as SVG and PNG, with the same bytes for the same picture."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path

from camwright.house.fonts import font_folders
from camwright.house.pictures import Picture
from camwright.house.svg import picture_svg

PIXELS_PER_INCH = 150.0
"""Resolution of a PNG: 12 pt are whole pixels, on which frames begin and end, so that their lines are drawn without a seam."""


def write_pictures(pictures: Mapping[str, Picture], directory: Path) -> list[Path]:
    """Write pictures by name, each as SVG and PNG; typst, which sets the sheets anyway, turns lines into pixels."""
    import typst

    fonts = typst.Fonts(include_system_fonts=False, font_paths=font_folders())
    files = []
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "page.typ"
        for name, picture in pictures.items():
            vector, pixels = directory / f"{name}.svg", directory / f"{name}.png"
            svg = picture_svg(picture)
            vector.write_text(svg, encoding="utf-8")
            page.with_suffix(".svg").write_text(svg, encoding="utf-8")
            size = f"width: {picture.width:g}pt, height: {picture.height:g}pt"
            page.write_text(
                f'#set page({size}, margin: 0pt, fill: white)\n#image("page.svg", {size})\n', encoding="utf-8"
            )
            compiler = typst.Compiler(root=folder, font_paths=fonts)
            compiler.compile(input=str(page), output=str(pixels), format="png", ppi=PIXELS_PER_INCH)
            files += [vector, pixels]
    return files
