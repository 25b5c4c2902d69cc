"""Hard cases: what usually breaks material point codes. `python -m rsmpm_ti.hardcases`."""
