"""The vehicle and its equations of motion: bodies, suspension, ground, the paper's equations and the kernel."""
