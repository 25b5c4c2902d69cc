"""What the material point method is: shape functions, transfers, time step."""
