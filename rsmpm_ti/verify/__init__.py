"""Independent truth to hold runs against: finite-element fields of slit specimens."""
