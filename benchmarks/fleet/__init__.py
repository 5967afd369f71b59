"""A simulated fleet whose faults are known: MuJoCo arms in daily use, and what `cdia trend` says of them."""
