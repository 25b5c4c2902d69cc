"""Specimens from drawings: regions that are an outline, an image or a mesh, and what their files must be."""
