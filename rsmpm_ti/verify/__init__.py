"""`python -m rsmpm_ti.verify`: the solver against exact solutions, finite elements and published data."""
