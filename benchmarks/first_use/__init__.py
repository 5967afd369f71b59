"""What was asked of the first use of the program, and whether it is met: measured, or held by a test."""
