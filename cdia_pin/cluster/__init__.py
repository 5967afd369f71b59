"""Many independent pieces of work on the cores of this machine or on a cluster, one result as each finishes."""

from cdia_pin.cluster.finished import ClusterError, Finished
from cdia_pin.cluster.run_each import run_each

__all__ = ["ClusterError", "Finished", "run_each"]
