"""Find which physical effect a robot arm's model is missing, name it, add it, watch the error fall."""

__version__ = "0.1.0"
