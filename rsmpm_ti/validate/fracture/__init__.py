"""Cracks that grow at a fracture energy: notched beams and plates."""
