"""What was asked of the first use, with the tests that hold it."""

from __future__ import annotations

from dataclasses import dataclass

BROWSER = "tests/browser/"
APP, FILES, REPORT = BROWSER + "test_app.py", BROWSER + "test_app_files.py", BROWSER + "test_report.py"
SCENE, VIEWERS, LOGS, CLI = BROWSER + "test_scene.py", "tests/viewers/", "tests/logs/", "tests/cli/"
FORMATS, CONTENTS = LOGS + "test_formats.py", "tests/exports/test_contents.py"
EXAMPLES = "docs/checks/test_examples.py"
FILES_DROPPED = f"{FILES}::test_from_dropped_files_to_an_added_effect_that_a_reload_keeps"


@dataclass(frozen=True)
class Promise:
    """Something that tests hold.

    Attributes:
        area: Heading under which it stands.
        text: What was asked for.
        tests: Files of tests, or ``file::test``.
        figure: Name of the property that the tests record, if they measure something; the largest is shown.
        target: What the figure may be at most.
    """

    area: str
    text: str
    tests: tuple[str, ...]
    figure: str = ""
    target: float = 0.0


def _of(area: str, *promises: tuple[str, ...]) -> list[Promise]:
    return [Promise(area, text, tuple(tests)) for text, *tests in promises]


PROMISES = [
    *_of(
        "App",
        (
            "a log with currents and foreign joint names, to an added effect; a URDF dropped without its meshes, which "
            "are one line; a typo keeps its text; one clock; reload",
            FILES_DROPPED,
        ),
        (
            "columns of any names are chosen at the error",
            f"{FILES}::test_columns_of_any_names_are_chosen_at_the_error",
        ),
        (
            "420 px wide, with Export in reach",
            f"{FILES}::test_a_phone_needs_no_scrolling_sideways_and_has_export_in_reach",
        ),
        (
            "the whole arm in the frame, with what it stands on",
            f"{SCENE}::test_the_whole_arm_is_in_the_picture_in_every_pose",
            f"{SCENE}::test_what_an_arm_stands_on_is_in_the_picture_unless_the_arm_would_be_small",
        ),
        ("on a long result, the tail is folded", f"{APP}::test_the_tail_of_a_long_result_is_folded"),
        (
            "the worst joint keeps its mark at every width, whichever is selected",
            f"{APP}::test_the_worst_joint_is_marked_at_every_width_whichever_is_selected",
        ),
        ("gains are typed in", f"{FILES}::test_gains_that_are_typed_load_a_log_of_currents"),
        (
            "*While it moves* is found again after a reload",
            f"{APP}::test_a_reload_finds_the_run_its_form_and_its_events",
        ),
        ("confidence and groups as `discover` has them", f"{APP}::test_from_a_log_to_what_is_missing"),
        (
            "the selected joint is that of the link that was clicked",
            f"{APP}::test_a_click_on_a_link_chooses_its_joint",
        ),
    ),
    *_of(
        "Report",
        ("the same groups everywhere", f"{VIEWERS}test_effect_groups.py::test_every_view_shows_the_same"),
        ("paper has the arm, and groups unfolded", f"{REPORT}::test_paper_has_a_still_picture_of_the_arm"),
        (
            "paper has no stranded heading, and no hint for a mouse",
            f"{REPORT}::test_on_paper_no_heading_is_left_at_the_end_of_a_page",
            f"{REPORT}::test_paper_has_no_hints_for_a_mouse",
        ),
        ("420 and 390 px wide", f"{REPORT}::test_a_narrow_window_needs_no_scrolling_sideways"),
    ),
    *_of(
        "Command line",
        ("80 columns lose nothing, nor 60 nor a pipe", f"{VIEWERS}test_narrow_terminals.py"),
        ("each command ends with the next one to type", f"{CLI}test_command_next.py"),
        ("no internals in messages", "tests/test_messages.py"),
    ),
    *_of(
        "Formats",
        ("UR RTDE, libfranka, LeRobot: read, recognised, `--format`", FORMATS),
        ("ROS 2 MCAP and db3", f"{LOGS}test_reading_other_formats.py", f"{LOGS}test_joint_states.py"),
        (
            "CSV of any names, by dialogue in a terminal",
            f"{CLI}test_command_formats.py",
            f"{LOGS}test_guessing_columns.py",
        ),
    ),
    Promise(
        "Exports",
        "MJCF in MuJoCo against our torque, six arms, largest difference over the torque",
        ("tests/exports/test_mjcf.py::test_mujoco_computes_our_torque",),
        "difference",
        0.01,
    ),
    *_of(
        "Exports",
        (
            "a corrected URDF in MuJoCo against our torque, within 1 %",
            "tests/exports/test_mjcf.py::test_mujoco_computes_our_torque_from_the_corrected_urdf",
        ),
        (
            "Drake and Isaac Lab as text",
            f"{CONTENTS}::test_the_lines_for_drake_set_damping_and_rotor_inertia",
            f"{CONTENTS}::test_isaac_lab_has_friction_at_rest_and_in_motion",
        ),
        (
            "a UR payload: mass and centre",
            f"{CONTENTS}::test_a_ur_is_told_mass_centre_and_inertia_in_the_flange",
        ),
        (
            "`--ranges`: intervals as bounds",
            f"{CONTENTS}::test_ranges_are_the_intervals_within_the_physical_bounds",
        ),
        (
            "what a format cannot hold is listed with its torque",
            f"{CONTENTS}::test_the_torque_left_out_is_that_of_the_term",
            f"{CONTENTS}::test_friction_of_the_load_is_left_out_with_its_torque",
        ),
        (
            "`asymmetric` friction exports its mean, and says so",
            f"{CONTENTS}::test_asymmetric_friction_is_held_as_its_mean",
        ),
    ),
    *_of(
        "Arms",
        (
            "each arm of a wheel is a sound chain, with its licence",
            "tests/robot/test_catalogue.py",
            f"{CLI}test_command_lists.py",
        ),
        ("arms that are fetched, and what is said without a network", "tests/robot/test_fetched_robots.py"),
        (
            "the best-fitting arm is suggested",
            f"{LOGS}test_checks.py::test_a_log_of_another_bundled_arm_is_named",
            f"{LOGS}test_checks.py::test_an_arm_is_named_though_another_gain_would_do_as_well",
        ),
    ),
    *_of(
        "Docs",
        ("every effect has an entry with a sentence of physics", "docs/checks/test_catalogue.py"),
        (
            "Python and commands in the pages run to their end",
            f"{EXAMPLES}::test_the_python_of_a_page_runs",
            f"{EXAMPLES}::test_a_command_of_a_page_runs",
        ),
        (
            "of commands that wait for a browser, take minutes or need one machine's folder, the options are read",
            f"{EXAMPLES}::test_a_command_that_is_not_run_has_the_options_of_its_page",
        ),
        ("messages of the page on troubleshooting are the program's", "docs/checks/test_troubleshooting.py"),
        ("examples are numbered, under 60 lines, of public names", "docs/checks/test_gallery.py"),
    ),
]
