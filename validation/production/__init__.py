<<<<<<< HEAD
"""What production does to a cam: the line ramps."""
=======
"""What a line asks for beside its steady cycle: starts and stops, judged."""
>>>>>>> 62b521f (Starts and stops over the master: ramps with least peak, heat or length, proved, and their tables)
