"""The report of a standard test: one HTML file that needs no other, no network and no script."""
