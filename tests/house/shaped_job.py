"""A servo-aware job of the knife: commands shaped so that the axis is in sync at every line speed, least sync error."""

JOB = """
name = "band"
[machine]
kind = "rotary_knife"
circumference = "400 mm"
[cut]
length = "300 mm"
line_speed = "80 m/min"
sync_zone = "120 mm"
shear_zone = "40 mm"
sync_tolerance = "0.1 mm"
[limits]
speed = "200 m/min"
acceleration = "100 m/s^2"
jerk = "20000 m/s^3"
[servo]
bandwidth = "120 rad/s"
damping = 0.7
position_gain = "35 1/s"
sample_time = "4 ms"
velocity_feedforward = 1.0
[objective]
servo_aware = true
command = "shaped"
minimise = "sync_error"
[output]
origin = "return"
"""
