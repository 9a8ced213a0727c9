"""What several commands print for people: rich tables."""
