"""A rock from its data sheet: numbers as a laboratory reports them, and the laws that they make."""
