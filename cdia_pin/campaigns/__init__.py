"""Studies and campaigns: many runs, or one that is looked at closely; what they return is numbers."""
