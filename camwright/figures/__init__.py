"""Figures of a design, of a comparison and of an audit, one module a figure; they draw results and compute none."""
