"""Every benchmark can still be run: what it takes from the package is there."""

import importlib
import pkgutil

import pytest

import benchmarks

ELSEWHERE = (
    "benchmarks.peers.figaroh",
    "benchmarks.peers.pysindy",
)  # run where these libraries are installed
MODULES = [
    module.name
    for module in pkgutil.walk_packages(benchmarks.__path__, "benchmarks.")
    if not module.name.startswith(ELSEWHERE)
]


@pytest.mark.parametrize("name", MODULES)
def test_imports(name):
    importlib.import_module(name)
