"""What is fitted and to what: the file of targets, as numbers."""
