"""What a line asks for beside its steady cycle: starts and stops, designed."""
