"""Pages, figures and tables of studies."""
