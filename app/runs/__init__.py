"""From the latest wish to a run, and the runs that are kept."""
