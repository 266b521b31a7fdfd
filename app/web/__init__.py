"""The web server: who may open the explorer, and what viser's server lacks."""
