"""The explorer and the command line."""

import os

# Before NumPy loads: the matrices here are small, and threads only make each other wait.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
