"""Stress of broken rock: of cracks with a direction, and of crushed rock."""
