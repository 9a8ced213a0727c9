"""What the keys of a job file mean, and what uses them; a machine says it of its own keys."""

from __future__ import annotations

MACHINE_KIND = ("which machine", "every command")
"""Meaning and use of ``[machine] kind``."""

MEANINGS: dict[str, tuple[str, str]] = {
    "name": ("names the job, its output directory and its tables", "every command that writes"),
    "cut.length": ("cut length: master travel from cut to cut", "every command"),
    "cut.line_speed": ("line speed: how fast the material runs", "every command"),
    "cut.sync_zone": ("length of material over which the tool moves with it", "every command"),
    "cut.shear_zone": ("part of the sync zone that the cut itself takes", "servo checks, servo-aware design"),
    "cut.shear_zone_at": (
        "where the shear zone begins, from the start of the sync zone; at the end of the sync zone if left out",
        "servo checks, servo-aware design",
    ),
    "cut.sync_tolerance": ("what the axis may be off the material in the shear zone", "servo checks, minimum lengths"),
    "cut.sync_ratio": ("speed of the tool over that of the material in the sync zone", "every command"),
    "limits.speed": ("greatest speed of the slave", "design, limits, every check"),
    "limits.acceleration": ("greatest acceleration of the slave", "design, limits, every check"),
    "limits.jerk": ("greatest jerk of the slave", "design, limits, every check"),
    "limits.reversal": ("whether the slave may run backwards", "design, limits, every check"),
    "limits.motor": ("torque that the motor gives over its speed", "design, motor checks"),
    "line.acceleration": (
        "greatest acceleration with which the line speeds up and slows down; the cam keeps its limits meanwhile, at every phase",
        "design, checks, limits",
    ),
    "line.stop": (
        "deceleration of the line's emergency stop; the cam keeps its limits meanwhile; that of any ramp if left out",
        "design, checks, limits",
    ),
    "line.jerk": (
        "greatest jerk with which these come and go; if left out, the corners of a ramp are not looked at",
        "design, checks, limits",
    ),
    "servo.bandwidth": ("bandwidth of the velocity loop", "servo simulation"),
    "servo.damping": ("damping ratio of the velocity loop", "servo simulation"),
    "servo.position_gain": ("gain of the position loop", "servo simulation"),
    "servo.sample_time": ("period at which the position loop samples", "servo simulation"),
    "servo.velocity_feedforward": ("share of the command's velocity that is fed forward", "servo simulation"),
    "servo.dead_time": ("delay from the encoder to the command", "servo simulation, length errors"),
    "servo.lead_time": (
        "time by which the controller leads the command to make up for delay",
        "servo simulation, length errors",
    ),
    "servo.acceleration_feedforward": (
        "factor on the command's acceleration in the position regulated to; 2 damping / (bandwidth position_gain) undoes the velocity loop",
        "servo simulation",
    ),
    "servo.jerk_feedforward": (
        "factor on the command's jerk there; 1 / (bandwidth^2 position_gain) undoes the velocity loop",
        "servo simulation",
    ),
    "servo.tolerance.bandwidth": ("range of the bandwidth", "robust design, random servos"),
    "servo.tolerance.damping": ("range of the damping ratio", "robust design, random servos"),
    "servo.tolerance.position_gain": ("range of the position gain", "robust design, random servos"),
    "servo.tolerance.sample_time": ("range of the sample time", "robust design, random servos"),
    "servo.tolerance.dead_time": ("range of the dead time", "robust design, random servos"),
    "objective.servo_aware": ("whether the axis, not only its command, keeps the sync tolerance", "design"),
    "objective.minimise": ("what is made least", "design, comparison"),
    "objective.command": (
        "whether a servo-aware design keeps its command in sync in the whole sync zone, or only its axis in the shear zone",
        "servo-aware design",
    ),
    "objective.line_speeds": (
        "line speeds at which the axis of a servo-aware design must be in sync: the ends of a range, or the job's alone",
        "servo-aware design, checks",
    ),
    "output.origin": ("master zero: start of the return zone, or mid sync zone", "cam tables, master positions"),
    "output.points": ("rows of cam.csv", "cam.csv"),
    "output.counts": (
        "counts of the encoders of master and slave, for targets that store counts",
        "export, recipe, book",
    ),
    "output.targets": ("drives that tables are written for where no option names them", "export, recipe, book"),
}
"""Meaning and use of each key by its place."""
