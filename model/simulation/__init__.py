"""From a configuration to a run: steppers, integration, a drive without end, many runs at once."""
