"""Hard cases: what breaks a material point code, and whether it breaks this one. `python -m rsmpm_ti.stress`."""
