"""What is read off a run: ride figures, comfort, spectrum, energy, and the vehicle's modes."""
