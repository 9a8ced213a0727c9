"""Cam tables for drives: written, read back, judged, audited."""
