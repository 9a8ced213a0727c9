"""What is possible at all: feasibility, how far, and the refusal that names what binds and what would work."""
