"""The monitor over measured logs: healthy ones, a known weight, pushes, and known effects from the middle on."""
