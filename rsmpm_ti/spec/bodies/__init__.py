"""What fills bodies: particles, and rocks."""
