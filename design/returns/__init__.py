"""The return between two sync zones as one problem: scaled, transcribed, solved, its structure read, polished."""
