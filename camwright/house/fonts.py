"""The fonts that sheets and figures are set in: DejaVu Sans, which camwright carries, and Noto Sans SC, which a package does."""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec
from pathlib import Path

_LATIN = Path(__file__).with_name("typefaces") / "DejaVuSans.ttf"
_HAN = ("pylopdf_fonts_zh_cn", "NotoSansSC-Regular.otf")


@cache
def font_files() -> tuple[Path, Path]:
    """Find DejaVu Sans and Noto Sans SC.

    Raises
    ------
    ModuleNotFoundError
        The package that carries the latter is not installed.
    """
    package, name = _HAN
    spec = find_spec(package)
    if spec is None or spec.origin is None:
        raise ModuleNotFoundError(f"the package {package}, which carries the font {name}, is not installed")
    return _LATIN, Path(spec.origin).parent / name


def font_folders() -> list[str]:
    """Name the folders of the fonts, as typst takes them."""
    return [str(font.parent) for font in font_files()]
