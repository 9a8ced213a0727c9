"""What a cam is: profiles, motion laws, returns, machines, the servo's model, cam tables. Numbers only, SI units."""
