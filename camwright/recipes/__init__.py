"""The recipe: all that one product needs on one machine, as a folder that opens without camwright."""
