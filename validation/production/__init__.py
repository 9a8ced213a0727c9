"""What production does to a cam: ramps of the line, starts and stops, judged."""
