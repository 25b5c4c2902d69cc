"""Failure criteria whose envelope is curved: of intact rock over a wide range of pressure, and of rock masses."""
