"""Predictions against experiments: what the method can say about real rock, and what it cannot."""
