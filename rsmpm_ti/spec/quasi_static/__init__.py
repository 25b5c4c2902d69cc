"""What keeps a test quasi-static while rock breaks."""
