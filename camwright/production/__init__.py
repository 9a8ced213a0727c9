"""What a line asks for beside its steady cycle: starts, stops, marks, cut lists, and a shift of them all."""
