"""Commands of studies, and what all commands have in common; no viser."""
