"""Measured logs of real arms: what `cdia discover` and `cdia identify` make of them.

python -m benchmarks                  # cdia discover, run as a user would run it: docs/results.md
python -m benchmarks.measured_logs    # full identification, joint by joint: docs/results-measured.md
"""
