"""Returns of least torque or energy at the motor, and returns within its torque-speed curve."""
