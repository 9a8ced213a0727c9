"""The die-rule bender as data and numbers in SI units: die lines, bends, springback, NC programs."""
