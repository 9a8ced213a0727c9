"""The command line, one module a command: arguments, study, answer, view."""
