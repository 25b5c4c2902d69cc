"""Many steps: chunks of steps, surveys, history, guard, and copies for those outside."""
