"""`python -m rsmpm_ti.bench`: speed as ratios in one run, and speed against error."""
