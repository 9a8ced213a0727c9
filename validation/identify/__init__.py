"""The servo's parameters from a recorded trace."""
