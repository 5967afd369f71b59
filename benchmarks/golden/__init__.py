"""The golden set: fixed cases whose answers two states of the code must share to 1e-9."""
