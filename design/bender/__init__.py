"""The fastest moves of the die-rule bender."""
