"""Rock that fails against closed forms: envelopes, strengths, cells that crack."""
