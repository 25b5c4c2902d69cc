"""Finite-element fields that the solver is held against, kept as files, and what makes and reads them."""
