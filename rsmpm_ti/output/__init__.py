"""The files of a run, and the process that paints and writes them."""
