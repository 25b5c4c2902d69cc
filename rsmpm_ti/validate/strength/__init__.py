"""Strength of intact rock against stress: envelopes that were measured on rock."""
