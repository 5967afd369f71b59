"""Studies and campaigns: many runs, or one closed loop in detail; their results are numbers."""
