"""A recorded run laid over the cam that it should have been."""
