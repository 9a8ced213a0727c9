"""What no cam can go below: lower bounds of objectives, minimum cut lengths."""
