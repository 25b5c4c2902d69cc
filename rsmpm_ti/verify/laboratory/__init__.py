"""What a user gets: scenes and set-ups as they ship, with the settings that ship, to failure and beyond."""
