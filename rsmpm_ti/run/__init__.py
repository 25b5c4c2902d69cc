"""One run of a scene, from its start to its last file."""
