"""Standard tests of rock: `python -m rsmpm_ti.lab TEST --rock FILE` runs specimens and writes the report."""
