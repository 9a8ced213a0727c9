"""Judges any profile against limits, discrete servo, bounds and minimum lengths; shares no code with the design."""
