"""What is measured against what: the independent plant, and the studies that use it."""
