"""What production does to a cam: the line ramps."""
