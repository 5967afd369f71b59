"""What the numbers that decide are worth: each setting of a discovery halved and doubled, on draws of its own."""
