"""The fonts that sheets are set in, which other packages carry."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

_LATIN = ("matplotlib", "mpl-data/fonts/ttf", "DejaVuSans.ttf")
_HAN = ("pylopdf_fonts_zh_cn", "", "NotoSansSC-Regular.otf")


def font_files() -> tuple[Path, Path]:
    """Find DejaVu Sans and Noto Sans SC.

    Raises
    ------
    ModuleNotFoundError
        The package that carries one is not installed.
    """
    latin, han = (_file(*place) for place in (_LATIN, _HAN))
    return latin, han


def font_folders() -> list[str]:
    """Name the folders of the fonts, as typst takes them."""
    return [str(font.parent) for font in font_files()]


def _file(package: str, folder: str, name: str) -> Path:
    spec = find_spec(package)  # without importing it: matplotlib is large
    if spec is None or spec.origin is None:
        raise ModuleNotFoundError(f"the package {package}, which carries the font {name}, is not installed")
    return Path(spec.origin).parent / folder / name
