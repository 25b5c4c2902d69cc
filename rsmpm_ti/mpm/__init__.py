"""One step of the material point method."""
