"""Two known effects put into the second of two measured logs: does `compare` name both?

- `cases`: every pair of effects on every pair of logs; a case is a name, and its name is its seed.
- `trial`: one case from beginning to end, and what came of it.
- `page`: the claims and the page.
"""
