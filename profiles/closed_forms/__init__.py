"""Motions that have a closed form: rest to rest, from state to state, beyond a sync zone and back."""
