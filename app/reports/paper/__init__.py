"""The page that `trackride paper` writes."""
