"""Cam tables as drives hold them: knots, number formats, interpolators, and one module for each target."""
