"""What notebooks and programs get: a design that shows itself, draws itself, and gives its numbers as a table."""
