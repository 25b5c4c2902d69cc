"""Scene files: where they are found by name, what is told of one without running it, and how its run is named."""
