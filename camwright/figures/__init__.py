"""Figures of a design, of a comparison and of an audit, one module a figure; they draw results and compute none."""

from camwright.figures.files import (
    audit_figures,
    comparison_figure,
    design_figures,
    tradeoff_figures,
)

__all__ = ["audit_figures", "comparison_figure", "design_figures", "tradeoff_figures"]
