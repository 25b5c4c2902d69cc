"""Measured numbers, retyped from the papers that every line names."""
