"""The discrete servo run on a profile: phases, responses, sweeps, draws, and where the cut falls."""
