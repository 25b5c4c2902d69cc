"""What a run holds in memory: grid, particles, nodes, and in what order they meet."""
