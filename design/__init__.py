"""Finds the cam: job to problem to programme to IPOPT to profile. The only room that knows CasADi."""
