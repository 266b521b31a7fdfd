"""What a user may say of a vehicle, a road and a run: one table of parameters, their checks, YAML and back."""
