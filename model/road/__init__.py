"""Roads: their shapes as smooth pieces, their tables for the kernel, and the point nearest to a wheel."""
