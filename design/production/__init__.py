"""What a line asks for beside its steady cycle, designed: starts and stops, the line's speed over a list, transitions."""
