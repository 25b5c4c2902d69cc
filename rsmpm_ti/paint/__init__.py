"""Painters of frames, and what frames become: PNG files, a summary picture, movies. Imported only when needed."""
