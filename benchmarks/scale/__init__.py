"""What a log and a scenario cost, and what many of them need."""
