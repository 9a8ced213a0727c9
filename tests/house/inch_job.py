"""A job as it is written where lengths are inches."""

JOB = """
name = "boards"
[machine]
kind = "rotary_knife"
circumference = "15.75 in"
[cut]
length = "24 in"
line_speed = "260 ft/min"
sync_zone = "6 in"
shear_zone = "1.5 in"
sync_tolerance = "0.004 in"
[limits]
speed = "650 fpm"
acceleration = "100 ft/s^2"
jerk = "10000 ft/s^3"
[servo]
bandwidth = "120 rad/s"
damping = 0.7
position_gain = "35 1/s"
sample_time = "4 ms"
velocity_feedforward = 1.0
"""
