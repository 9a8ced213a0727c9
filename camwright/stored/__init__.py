"""What is written to disk of a design, and read again."""
