"""Pieces of polynomials: the profile, its roots, and fitting smooth curves by it."""
