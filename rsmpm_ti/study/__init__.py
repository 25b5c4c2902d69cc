"""Families of runs, each against a theory or against itself, with a table and one picture."""
