"""Rock on particles: the stress update, the failure check, cracks and what is averaged over the rock."""
