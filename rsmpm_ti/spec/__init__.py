"""What a scene is: frozen data, checked once, read and written."""
