"""How values, names, colours and HTML are written; no viser."""
