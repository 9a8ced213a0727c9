"""The die-rule bender's front door: drawings, bender jobs, springback tables, programs, figures."""
