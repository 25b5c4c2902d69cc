"""What broke, measured from records and scene alone: load curve, cracks, fragments, acoustic emission."""
