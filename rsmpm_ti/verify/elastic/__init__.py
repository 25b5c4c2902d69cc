"""Elastic rock against closed forms, finite elements and exact motions."""
