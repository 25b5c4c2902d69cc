"""Holes in rock: pressure on their walls, and rock that is excavated during a run."""
