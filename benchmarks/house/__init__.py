"""The state of the house: what can be counted in the source of a checkout, before and after a change."""
