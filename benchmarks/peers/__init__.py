"""Other tools on the cases of this one. None is needed by the package or its tests; what is absent is left out."""
