"""Job files and what they ask for."""
