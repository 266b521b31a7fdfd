"""The 3-D view: what a run looks like at an instant, and the viser nodes that show it."""
