"""Design with the ramps of the line inside: the slave keeps its limits while the line changes its speed."""
