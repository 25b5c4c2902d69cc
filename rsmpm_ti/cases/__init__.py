"""The harness of verification: a case, how cases run, their table and command line."""
