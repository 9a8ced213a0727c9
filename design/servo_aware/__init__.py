"""The axis, not its command, keeps to the material: the servo stands inside the programme."""
