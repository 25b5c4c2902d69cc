"""Rock in the ground: its weight, and the stress that it starts with."""
