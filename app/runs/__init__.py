"""From the latest request to a run, and the runs that are kept."""
