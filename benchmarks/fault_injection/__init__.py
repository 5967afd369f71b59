"""Samples that cannot be, given to a monitor: nothing may be raised, pushed or named, and later faults must be seen."""
