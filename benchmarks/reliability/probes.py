"""The kinds of probes: what is tried, which tests try it, and what is lost where it does not hold."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from tests.fuzzing.readers import READERS

DAMAGED = "tests/fuzzing/test_fuzzing.py::test_what_is_damaged_is_read_or_refused"
TERMINAL = "tests/cli/test_command_terminal.py"
WHOLE = "tests/test_whole_files.py"
CSV = "tests/logs/test_reading_csv.py"


@dataclass(frozen=True)
class Kind:
    """A kind of probe.

    Attributes:
        title: What is tried.
        promise: What has to happen.
        tests: Files, tests or cases of pytest that try it.
        at_stake: What a try that does not hold has lost; empty where nothing is.
    """

    title: str
    promise: str
    tests: tuple[str, ...]
    at_stake: str = ""

    def has(self, case: str) -> bool:
        """Return whether a case of pytest, as `file::test[parameters]`, belongs to this kind."""
        return any(case == test or case.startswith((f"{test}::", f"{test}[")) for test in self.tests)


def damaged(kinds: Iterable[str]) -> tuple[Kind, ...]:
    """Return a kind of probe for each kind of file that is fuzzed."""
    read = "read, or refused in one line"
    return tuple(Kind(f"damaged: {kind}", read, (f"{DAMAGED}[{kind}]",)) for kind in kinds)


KINDS = (
    *damaged(kind for kind in READERS if kind != "samples"),
    Kind(
        "samples of a monitor, damaged",
        "nothing is raised; corrections are finite and within the effort",
        (f"{DAMAGED}[samples]",),
    ),
    Kind(
        "files that broke a reader once",
        "read, or refused in one line",
        ("tests/fuzzing/test_fuzzing.py::test_what_broke_once_is_read_or_refused",),
    ),
    Kind(
        "an error at some byte of a file that is written",
        "the old file stays",
        (f"{WHOLE}::test_a_failure_at_any_byte_leaves_the_old_file_and_nothing_else",),
        "the old file",
    ),
    Kind(
        "a program killed while it writes",
        "the old file stays",
        (f"{WHOLE}::test_a_killed_program_leaves_the_old_file",),
        "the old file",
    ),
    Kind(
        "commands beyond a limit on the size of files",
        "one line, and the old file stays",
        ("tests/cli/test_command_outputs.py::test_a_limit_on_the_size_of_files_leaves_the_old_one",),
        "the old file",
    ),
    Kind("a full device", "said as an error", (f"{WHOLE}::test_a_device_takes_what_comes",)),
    Kind(
        "rows missing, at any rate and offset of the clock",
        "the log is read, right at every sample",
        ("tests/logs/test_derivatives.py::test_rows_may_be_missing_at_any_rate_and_offset_of_the_clock",),
        "the log",
    ),
    Kind(
        "wild samples",
        "exactly they are found and left out",
        ("tests/logs/test_wild_samples.py",),
        "sound samples",
    ),
    Kind(
        "CSV files that were cut off",
        "noticed; complete rows are read",
        (
            f"{CSV}::test_a_file_cut_off_anywhere_gives_all_of_its_complete_rows",
            f"{CSV}::test_a_last_row_that_is_cut_off_is_left_out_with_a_note",
            f"{CSV}::test_a_last_number_that_is_cut_off_is_noticed",
        ),
        "rows",
    ),
    Kind(
        "CSV files with a stray quotation mark",
        "refused, with its line",
        (f"{CSV}::test_a_stray_quote_is_refused_and_swallows_no_rows",),
        "rows",
    ),
    Kind(
        "logs whose joints have odd names, written as CSV",
        "read back as they were, or refused",
        (
            f"{CSV}::test_names_of_any_joints_are_read_back_or_refused",
            f"{CSV}::test_a_joint_whose_name_has_commas_and_quotes_is_read_back",
        ),
        "the log",
    ),
    Kind("odd URDF files", "read, or refused with what is wrong", ("tests/robot/test_odd_urdf.py",)),
    Kind(
        "odd logs and numbers for commands",
        "judged, or refused in one line",
        ("tests/cli/test_command_last_net.py",),
    ),
    Kind(
        "files that unpack to gigabytes, pipes, devices",
        "refused before they are read",
        ("tests/logs/test_bounded_reading.py", "tests/test_input_files.py"),
    ),
    Kind(
        "characters that control a terminal, in files and names",
        "none reaches it",
        (
            f"{TERMINAL}::test_a_printable_text_controls_nothing",
            f"{TERMINAL}::test_names_of_files_and_columns_do_not_reach_the_terminal_as_they_are",
            f"{TERMINAL}::test_names_in_models_do_not_either",
        ),
    ),
    Kind(
        "faults and models that no arm can have",
        "refused, or doubted",
        (
            f"{TERMINAL}::test_a_fault_that_no_arm_can_have_is_refused",
            f"{TERMINAL}::test_a_fault_that_is_larger_than_any_is_refused",
            f"{TERMINAL}::test_export_refuses_what_a_urdf_cannot_be",
            f"{TERMINAL}::test_a_model_with_a_number_that_no_arm_has_is_doubted",
        ),
    ),
    Kind(
        "foreign origins and wrong keys at the door of the app",
        "they get nothing",
        ("tests/viewers/test_door.py",),
        "what the app shows",
    ),
    Kind(
        "runs that are interrupted",
        "what was found is kept, and the run goes on",
        ("tests/cli/test_command_unfinished.py",),
        "what was found",
    ),
)
