"""One browser tab: its threads, its window, and what its user keeps at hand."""
