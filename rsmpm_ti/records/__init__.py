"""What leaves the solver: plain NumPy, no Taichi."""
