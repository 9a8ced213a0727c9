"""Figures of a design and of a comparison, one module a figure; they draw results and compute none."""

from camwright.plots.files import comparison_figure, design_figures

__all__ = ["comparison_figure", "design_figures"]
