"""Pages and sheets to read, print and pass on; no viser."""
