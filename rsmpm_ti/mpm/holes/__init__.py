"""What the walls of holes add to a step."""
