"""What a checkpoint may hold, and whether one that is found in a folder does: a stranger may have written it."""
