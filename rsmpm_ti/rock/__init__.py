"""What rock is: tensors, elasticity, failure criteria, laws after failure, viscosity, heterogeneity."""
