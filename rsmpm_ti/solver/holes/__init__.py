"""Rock that is taken out between two steps."""
