"""How the documentation is built: ``sphinx-build -W -b html docs out/docs``. Nothing is fetched, not by the build and not by a browser."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from latex2mathml.converter import convert

sys.path.insert(0, str(Path(__file__).parents[1]))

from camwright.house.provenance import camwright_version

project = "camwright"
author = "The camwright authors"
copyright = author
release = version = camwright_version()

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
suppress_warnings = [
    "myst.header",
    "myst.xref_missing",
]  # links to files beside the documents are links of the repository
source_suffix = {".md": "markdown"}
exclude_patterns = ["_build"]

autodoc_typehints = "none"
autodoc_member_order = "bysource"
napoleon_google_docstring = False
default_role = "code"

html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["camwright.css"]
html_title = f"camwright {release}"
html_copy_source = False
html_show_sphinx = False
html_last_updated_fmt = None


def _inline(writer: Any, node: Any) -> None:
    """Write a formula as MathML, which browsers show by themselves."""
    writer.body.append(convert(node.astext()))


def _block(writer: Any, node: Any) -> None:
    writer.body.append(convert(node.astext(), display="block"))


def setup(app: Any) -> None:
    """Set formulas without a script."""
    app.add_html_math_renderer("mathml", (_skipping(_inline), None), (_skipping(_block), None))
    app.config.html_math_renderer = "mathml"


def _skipping(visit: Any) -> Any:
    from docutils.nodes import SkipNode

    def visited(writer: Any, node: Any) -> None:
        visit(writer, node)
        raise SkipNode

    return visited
