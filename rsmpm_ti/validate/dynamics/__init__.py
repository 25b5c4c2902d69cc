"""Waves that break rock, and cracks that run."""
