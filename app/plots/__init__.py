"""What the plots show: curves of a run, thinned to what pixels show; no viser."""
