"""Rock in the ground: its weight, the stress that it starts with, and how it comes to rest before a run."""
