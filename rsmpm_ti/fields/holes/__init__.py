"""Forces on the walls of holes."""
