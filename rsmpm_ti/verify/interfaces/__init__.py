"""Rocks beside each other: layers and inclusions."""
