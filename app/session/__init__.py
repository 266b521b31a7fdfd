"""One browser tab: its threads, its window, the workspace of its user, downloads and uploads."""
