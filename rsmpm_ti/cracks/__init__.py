"""Cracks as measured objects, from failure events and snapshots: paths, wings, growth, opening, pieces, emission."""
