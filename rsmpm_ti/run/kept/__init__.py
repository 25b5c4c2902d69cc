"""Checkpoints as they are found in a folder: a stranger may have written them, so nothing in them is believed."""
