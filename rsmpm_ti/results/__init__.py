"""What a run hands out: its tables, and its curve, frames and movie as a notebook shows them."""
