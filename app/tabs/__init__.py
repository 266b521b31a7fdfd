"""What the tabs beside the plots say, as HTML; no viser."""
