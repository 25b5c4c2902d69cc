"""A rock fitted to measurements: `python -m rsmpm_ti.calibrate --rock FILE --to TARGETS.toml`."""
