"""Data goes one way: a module imports only from what stands above it."""

import ast
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "cdia_pin"

# From the robot to what people see. A new folder gets its place here.
ORDER = (
    "robot",
    "effects",
    "logs",
    "dynamics",
    "exports",
    "regression",
    "selection",
    "identifiability",
    "identification",
    "excitation",
    "changes",
    "discovery",
    "diagnosis",
    "cluster",
    "fleet",
    "campaigns",
    "viewers",
    "app",
    "cli",
)
# Below everything: leaves.
COMMON = (
    "version",
    "schemas",
    "errors",
    "extras",
    "phrases",
    "decoding",
    "plain_json",
    "progress",
    "threads",
    "resources",
    "whole_files",
    "input_files",
    "fault_report",
)
DOORS = ("__init__", "__main__", "ipython")  # lead into the package from outside

MODULES = sorted(p for p in PACKAGE.rglob("*.py") if p.relative_to(PACKAGE).parts[0] != "_data")


def part_of(path: Path) -> str:
    return path.relative_to(PACKAGE).with_suffix("").parts[0]


def imported_parts(path: Path) -> Iterator[tuple[int, str]]:
    """Line and part of the package of every import, also inside functions and for types only."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: imports are written in full"
            base = node.module or ""
            names = [f"{base}.{a.name}" for a in node.names] if base == "cdia_pin" else [base]
        else:
            continue
        for name in names:
            if name.startswith("cdia_pin."):
                yield node.lineno, name.split(".")[1]


def may_import(importer: str, imported: str) -> bool:
    if imported in COMMON or imported == "__version__" or importer == imported:
        return True
    if importer in COMMON or imported not in ORDER:
        return False
    return ORDER.index(imported) < ORDER.index(importer)


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_a_module_imports_only_from_above(path):
    importer = part_of(path)
    if importer in DOORS:
        return
    assert importer in (*ORDER, *COMMON), f"give '{importer}' its place in ORDER"
    wrong = [f"line {line}: {part}" for line, part in imported_parts(path) if not may_import(importer, part)]
    assert not wrong, f"{importer} stands above what it imports: {', '.join(wrong)}"


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_the_package_itself_is_only_asked_for_its_version(path):
    # cdia_pin.discover and its like are loaded on first use: an import in disguise
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if (
            isinstance(node, ast.Attribute)
            and isinstance(node.value, ast.Name)
            and node.value.id == "cdia_pin"
        ):
            assert node.attr == "__version__", f"line {node.lineno}: cdia_pin.{node.attr}"


def test_the_rules_are_what_they_say():
    assert may_import("effects", "robot")
    assert may_import("cli", "discovery")
    assert may_import("logs", "errors")
    assert not may_import("robot", "effects")
    assert not may_import("viewers", "app")
    assert not may_import("app", "cli")
    assert not may_import("errors", "robot")


def names_of_modules() -> dict[str, Path]:
    """Modules by dotted name; a folder's door has the folder's name."""
    dotted = {p: ".".join(("cdia_pin", *p.relative_to(PACKAGE).with_suffix("").parts)) for p in MODULES}
    return {name.removesuffix(".__init__"): p for p, name in dotted.items()}


def imported_modules(path: Path, known: dict[str, Path]) -> set[str]:
    """Modules of the package that a module imports, also inside functions and for types only."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                found.add(inner if inner in known else node.module)
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
    return found & set(known)


def test_no_module_imports_itself_through_others():
    known = names_of_modules()
    graph = {name: imported_modules(path, known) - {name} for name, path in known.items()}
    try:
        list(TopologicalSorter(graph).static_order())
    except CycleError as error:
        pytest.fail(f"a circle of imports: {' → '.join(error.args[1])}")
