"""CSV as people write it is read; what cannot be used is refused in one clear line."""

import time as clock
from xml.sax.saxutils import quoteattr

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from cdia_pin.errors import LogError
from cdia_pin.logs import Log, read_log, write_log
from cdia_pin.logs.log_writer import columns_of
from cdia_pin.logs.readers.csv import read_csv
from cdia_pin.phrases import printable
from cdia_pin.robot import load_robot
from tests.one_joint import write_urdf

ROWS = 40


def text_of(joints, *, signals=("position", "velocity", "effort"), delimiter=",", newline="\n", digits=6):
    """A small log as text, with values that name their row and column."""
    header = ["time", *(f"{s}.{j}" for s in signals for j in joints)]
    rows = [
        [f"{0.01 * r:.{digits}f}", *(f"{c + r / 100:.{digits}f}" for c in range(len(header) - 1))]
        for r in range(ROWS)
    ]
    return newline.join(delimiter.join(line) for line in [header, *rows]) + newline


def write(path, text, encoding="utf-8"):
    path.write_bytes(text.encode(encoding))
    return path


@pytest.fixture
def plain(ur5, tmp_path):
    return read_log(write(tmp_path / "plain.csv", text_of(ur5.joints)), ur5)


def same(a: Log, b: Log) -> bool:
    return all(
        np.array_equal(getattr(a, s), getattr(b, s)) for s in ("time", "position", "velocity", "effort")
    )


def test_the_dialect_is_read_in_the_robots_order(ur5, tmp_path, plain):
    assert plain.joints == ur5.joints
    assert plain.position[7, 2] == pytest.approx(2.07)
    assert plain.effort[7, 2] == pytest.approx(14.07)
    backwards = read_log(write(tmp_path / "b.csv", text_of(ur5.joints[::-1])), ur5)
    np.testing.assert_array_equal(backwards.position, plain.position[:, ::-1])


def test_the_hash_is_that_of_the_files_bytes(ur5, tmp_path):
    import hashlib

    path = write(tmp_path / "a.csv", text_of(ur5.joints))
    assert read_log(path, ur5).sha256 == hashlib.sha256(path.read_bytes()).hexdigest()


@pytest.mark.parametrize(
    "change",
    [
        lambda t: t.replace(",", ";"),
        lambda t: t.replace(",", "\t"),
        lambda t: t.replace(",", "  "),
        lambda t: t.replace("\n", "\r\n"),
        lambda t: t.replace("\n", "\r"),
        lambda t: "\ufeff" + t,
        lambda t: "# a robot\n# on a day\n" + t.replace("\n0.1", "\n# half way\n0.1", 1),
        lambda t: "# " + t,
        lambda t: t.replace(",", " , "),
        lambda t: t.rstrip("\n"),
        lambda t: t + "\n\n",
        lambda t: '"' + '","'.join(t.split("\n", 1)[0].split(",")) + '"\n' + t.split("\n", 1)[1],
    ],
)
def test_separators_comments_line_ends_and_marks_change_nothing(ur5, tmp_path, plain, change):
    assert same(read_log(write(tmp_path / "x.csv", change(text_of(ur5.joints))), ur5), plain)


def test_utf16_with_a_mark_is_read(ur5, tmp_path, plain):
    assert same(read_log(write(tmp_path / "x.csv", text_of(ur5.joints), "utf-16"), ur5), plain)


def test_a_decimal_comma_is_read_and_noted(ur5, tmp_path, plain):
    header, body = text_of(ur5.joints, delimiter=";").split("\n", 1)
    log = read_log(write(tmp_path / "x.csv", header + "\n" + body.replace(".", ",")), ur5)
    assert same(log, plain)
    assert any("decimal comma" in note for note in log.notes)


@pytest.mark.parametrize("names", [("q", "dq", "tau"), ("pos", "vel", "torque"), ("q", "qd", "effort")])
@pytest.mark.parametrize("separator", [".", "/", "_"])
def test_aliases_and_separators_are_accepted(ur5, tmp_path, plain, names, separator):
    text = text_of(ur5.joints)
    for ours, theirs in zip(("position", "velocity", "effort"), names, strict=True):
        text = text.replace(f"{ours}.", f"{theirs}{separator}")
    assert same(read_log(write(tmp_path / "x.csv", text), ur5), plain)


@pytest.mark.parametrize("form", ["q_{}", "q{}", "q.{}", "q[{}]"])
@pytest.mark.parametrize("first", [0, 1])
def test_numbered_columns_follow_the_robots_order_with_a_note(ur5, tmp_path, plain, form, first):
    text = text_of(ur5.joints)
    for k, joint in enumerate(ur5.joints):
        number = str(k + first)
        text = text.replace(f"position.{joint}", form.format(number))
        text = text.replace(f"velocity.{joint}", "d" + form.format(number))
        text = text.replace(f"effort.{joint}", form.replace("q", "tau").format(number))
    log = read_log(write(tmp_path / "x.csv", text), ur5)
    assert same(log, plain)
    assert any("numbered" in note for note in log.notes)


def test_topics_before_joints_and_dates_as_times_are_accepted(ur5, tmp_path, plain):
    lines = text_of(ur5.joints).splitlines()
    names = [name.split(".") for name in lines[0].split(",")[1:]]
    header = ["time", *(f"/joint_states/{joint}/{signal}" for signal, joint in names)]
    rows = [f"2024-05-01T12:00:{0.01 * k:06.3f}," + line.split(",", 1)[1] for k, line in enumerate(lines[1:])]
    log = read_log(write(tmp_path / "x.csv", "\n".join([",".join(header), *rows])), ur5)
    np.testing.assert_allclose(log.time, plain.time, atol=1e-9)
    np.testing.assert_array_equal(log.velocity, plain.velocity)
    assert any("since 1970" in note for note in log.notes)


def test_velocity_may_be_missing_and_is_not_filled_in(ur5, tmp_path):
    path = write(tmp_path / "x.csv", text_of(ur5.joints, signals=("position", "effort")))
    log = read_log(path, ur5)
    assert log.velocity is None
    assert any("no velocity recorded" in note for note in log.notes)


def test_velocity_of_some_joints_only_is_left_out_with_a_note(ur5, tmp_path):
    text = text_of(ur5.joints).replace("velocity.elbow_joint", "speed.elbow_joint")
    log = read_log(write(tmp_path / "x.csv", text), ur5)
    assert log.velocity is None
    assert any("velocity not used" in note for note in log.notes)


def test_joints_that_the_robot_lacks_are_ignored_with_a_note(ur5, tmp_path, plain):
    text = text_of((*ur5.joints, "finger_joint"))
    log = read_log(write(tmp_path / "x.csv", text), ur5)
    assert log.joints == plain.joints
    assert any("finger_joint" in note for note in log.notes)


def test_columns_of_text_are_ignored_unless_they_are_needed(ur5, tmp_path, plain):
    lines = text_of(ur5.joints).splitlines()
    text = "\n".join([lines[0] + ",state", *(line + ",RUNNING" for line in lines[1:])])
    assert same(read_log(write(tmp_path / "x.csv", text), ur5), plain)


def test_currents_need_gains_and_the_error_names_them(ur5, tmp_path):
    path = write(tmp_path / "x.csv", text_of(ur5.joints).replace("effort.", "current."))
    with pytest.raises(LogError, match=r"--gains gains\.json.*shoulder_pan_joint"):
        read_log(path, ur5)
    gains = {joint: 10.0 + k for k, joint in enumerate(ur5.joints)}
    log = read_log(path, ur5, gains=gains)
    assert log.effort[7, 2] == pytest.approx(14.07 * 12.0)
    assert any("N·m/A" in note for note in log.notes)


def test_efforts_that_are_currents_become_torques_on_request(ur5, tmp_path, plain):
    path = write(tmp_path / "x.csv", text_of(ur5.joints))
    gains = dict.fromkeys(ur5.joints, 10.0)
    assert same(read_log(path, ur5, gains=gains), plain)
    asked = read_log(path, ur5, gains=gains, convert={"torque": "A"})
    np.testing.assert_allclose(asked.effort, 10 * plain.effort)


def test_conversions_are_applied_and_noted(ur5, tmp_path, plain):
    path = write(tmp_path / "x.csv", text_of(ur5.joints))
    log = read_log(path, ur5, convert=["angle=deg", "torque=Nmm", "flip_effort=elbow_joint"])
    np.testing.assert_allclose(log.position, np.radians(plain.position))
    np.testing.assert_allclose(log.velocity, np.radians(plain.velocity))
    np.testing.assert_allclose(log.effort[:, 2], -1e-3 * plain.effort[:, 2])
    assert len([n for n in log.notes if "as asked" in n]) == 3


def test_compensated_gravity_is_added_back_on_request(ur5, tmp_path, plain):
    path = write(tmp_path / "x.csv", text_of(ur5.joints))
    log = read_log(path, ur5, convert="gravity=compensated")
    np.testing.assert_allclose(log.effort, plain.effort + ur5.gravity(plain.position))


def test_a_row_written_twice_counts_once(ur5, tmp_path, plain):
    lines = text_of(ur5.joints).splitlines()
    log = read_log(write(tmp_path / "x.csv", "\n".join([*lines[:10], lines[9], *lines[10:]])), ur5)
    assert same(log, plain)
    assert any("written twice" in note for note in log.notes)


def test_a_last_row_that_is_cut_off_is_left_out_with_a_note(ur5, tmp_path):
    text = text_of(ur5.joints)
    log = read_log(write(tmp_path / "x.csv", text[: -len(text.splitlines()[-1]) // 2]), ur5)
    assert len(log.time) == ROWS - 1
    assert any("cut off" in note for note in log.notes)


@pytest.mark.parametrize("left", [1, 3, 8])
def test_a_last_number_that_is_cut_off_is_noticed(ur5, tmp_path, left):
    lines = text_of(ur5.joints).splitlines()
    *cells, last = lines[-1].split(",")
    for rest in (last[:left], "", "-", "3e", "3e-"):
        text = "\n".join([*lines[:-1], ",".join([*cells, rest])])
        log = read_log(write(tmp_path / "a.csv", text), ur5)
        assert any("cut off" in note for note in log.notes), rest
        assert len(log.time) == (ROWS if rest == last[:left] else ROWS - 1)


@given(cut=st.floats(0.3, 1.0), newline=st.sampled_from(["\n", "\r\n"]))
@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_file_cut_off_anywhere_gives_all_of_its_complete_rows(ur5, tmp_path, plain, cut, newline):
    text = text_of(ur5.joints, newline=newline)
    text = text[: round(cut * len(text))]
    log = read_log(write(tmp_path / "a.csv", text), ur5)
    complete = text.count("\n") - 1  # less the header
    assert complete <= len(log.time) <= complete + 1
    for signal in ("time", "position", "velocity", "effort"):
        np.testing.assert_array_equal(getattr(log, signal)[:complete], getattr(plain, signal)[:complete])
    assert text.endswith(("\n", "\r")) or any("cut off" in note for note in log.notes)


@given(row=st.integers(1, ROWS - 2), column=st.integers(0, 18), after=st.booleans())
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_stray_quote_is_refused_and_swallows_no_rows(ur5, tmp_path, row, column, after):
    lines = text_of(ur5.joints).splitlines()
    cells = lines[row].split(",")
    cells[column] = cells[column] + '"' if after else '"' + cells[column]
    lines[row] = ",".join(cells)
    with pytest.raises(LogError, match=f"line {row + 1}.*quot"):
        read_log(write(tmp_path / "a.csv", "\n".join(lines) + "\n"), ur5)


@given(names=st.lists(st.text(min_size=1, max_size=12), min_size=1, max_size=4, unique=True))
@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@example(names=["a,b", 'c"d', "e;f", "g#h", "i'"])
@example(names=["a\nb"])
@example(names=["a,b,c;d;e;f;g;h"])
def test_names_of_any_joints_are_read_back_or_refused(tmp_path, names):
    values = np.arange(3.0 * len(names)).reshape(3, len(names))
    log = Log(tuple(names), np.array([0.0, 0.1, 0.2]), values, 2 * values)
    file = tmp_path / "a.csv"
    try:
        write_log(log, file)
    except LogError as error:
        assert any(n != printable(n).strip() for n in names), error
        assert printable(str(error)) == str(error) and ".parquet" in str(error)
        return
    table = read_csv(file.read_bytes(), "a.csv")
    assert list(table.columns) == list(columns_of(log))
    np.testing.assert_array_equal(table.columns[f"effort.{names[-1]}"], 2 * values[:, -1])


def with_name(folder, joint):
    """The URDF of an arm whose only joint has this name."""
    file = write_urdf("revolute", folder)
    file.write_text(file.read_text().replace('"only"', quoteattr(joint)))
    return file


def test_a_joint_whose_name_has_commas_and_quotes_is_read_back(tmp_path):
    name = 'elbow, "left"; 2'
    robot = load_robot(with_name(tmp_path, name))
    assert robot.joints == (name,)
    log = Log((name,), np.arange(20) / 10, np.linspace(0, 1, 20)[:, None], np.linspace(1, 2, 20)[:, None])
    again = read_log(write_log(log, tmp_path / "a.csv"), robot)
    np.testing.assert_array_equal(again.effort, log.effort)


def test_numbers_in_quotes_are_read(ur5, tmp_path, plain):
    lines = text_of(ur5.joints).splitlines()
    quoted = [",".join(f'"{cell}"' for cell in line.split(",")) for line in lines]
    assert same(read_log(write(tmp_path / "a.csv", "\n".join(quoted) + "\n"), ur5), plain)


def broken(text: str, kind: str) -> str:
    lines = text.splitlines()
    row = lines[8].split(",")
    changes = {
        "nan": lambda: row.__setitem__(3, "nan"),
        "empty cell": lambda: row.__setitem__(3, ""),
        "word": lambda: row.__setitem__(3, "oops"),
        "time back": lambda: row.__setitem__(0, "0.01"),
        "same time": lambda: row.__setitem__(0, lines[7].split(",")[0]),
        "short row": row.pop,
    }
    changes[kind]()
    lines[8] = ",".join(row)
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("kind", "said"),
    [
        ("nan", r"position\.elbow_joint holds 1 value.*sample 7"),
        ("empty cell", r"position\.elbow_joint holds 1 value.*sample 7"),
        ("word", r"position\.elbow_joint' must hold numbers, found 'oops' in sample 7"),
        ("time back", "time must increase"),
        ("same time", "samples 6 and 7 have the same time"),
        ("short row", "do not have the 19 columns"),
    ],
)
def test_a_bad_cell_is_named_by_column_and_sample(ur5, tmp_path, kind, said):
    with pytest.raises(LogError, match=said):
        read_log(write(tmp_path / "x.csv", broken(text_of(ur5.joints), kind)), ur5)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "empty"),
        (b"\n \n", "empty"),
        (b"# only a comment\n", "."),
        (b"time,position.a\n", "no samples"),
        (b"1,2,3\n4,5,6\n", "holds numbers, expected column names"),
        (bytes(range(256)) * 20, "binary"),
        (b"hello world, this is a letter\nnot a log, at all\n", "no position columns"),
        ("zeit;größe\n1;2\n".encode("latin-1"), "UTF-8"),
    ],
)
def test_a_file_that_is_not_a_log_is_refused_in_one_line(ur5, tmp_path, content, said):
    path = tmp_path / "x.csv"
    path.write_bytes(content)
    with pytest.raises(LogError, match=said) as error:
        read_log(path, ur5)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("change", [lambda t: t, lambda t: t.replace("time,", "row,")])
def test_rows_at_a_known_rate_need_no_times(ur5, tmp_path, change):
    path = write(tmp_path / "x.csv", change(text_of(ur5.joints)))
    log = read_log(path, ur5, convert=["rate=50"])
    np.testing.assert_allclose(log.time, np.arange(len(log.time)) / 50)
    assert "rows counted at 50 Hz, as asked; times are not read" in log.notes


def test_a_log_without_times_says_what_to_type(ur5, tmp_path):
    text = "\n".join(line.partition(",")[2] for line in text_of(ur5.joints).splitlines())
    path = write(tmp_path / "x.csv", text)
    with pytest.raises(LogError, match=r"no column 'time'.*--convert rate=100"):
        read_log(path, ur5)
    assert len(read_log(path, ur5, convert={"rate": 100}).time) == text.count("\n")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda t: t.replace("effort.", "temperature."), "no effort columns"),
        (lambda t: t.replace("position.", "angle."), "no position columns"),
        (lambda t: t.replace("time,", "clock,"), "no column 'time'"),
        (
            lambda t: t.replace("effort.elbow_joint", "effort.knee_joint"),
            "effort: no column for joint.* elbow_joint",
        ),
        (lambda t: t.replace("velocity.elbow_joint", "position.elbow_joint"), "appear more than once"),
        (lambda t: t.replace("velocity.elbow_joint", "q.elbow_joint"), "that another column has"),
    ],
)
def test_a_missing_or_doubled_signal_is_named(ur5, tmp_path, change, said):
    with pytest.raises(LogError, match=said):
        read_log(write(tmp_path / "x.csv", change(text_of(ur5.joints))), ur5)


def test_missing_files_unknown_suffixes_and_wrong_keywords_raise_log_errors(ur5, tmp_path):
    with pytest.raises(LogError, match="no such file"):
        read_log(tmp_path / "none.csv", ur5)
    with pytest.raises(LogError, match=r"unknown log format '\.xlsx'"):
        read_log(write(tmp_path / "x.xlsx", "x"), ur5)
    with pytest.raises(LogError, match="rosbags-convert"):
        read_log(write(tmp_path / "x.bag", "x"), ur5)
    path = write(tmp_path / "x.csv", text_of(ur5.joints))
    with pytest.raises(LogError, match="did you mean elbow_joint"):
        read_log(path, ur5, joint_map={"elbow": "elbow_joint"})
    with pytest.raises(LogError, match="more than one name"):
        read_log(path, ur5, joint_map={"elbow_joint": "wrist_1_joint", "wrist_1_joint": "wrist_1_joint"})


UNHURRIED = (HealthCheck.function_scoped_fixture, HealthCheck.too_slow)  # machines that do much else


@settings(max_examples=40, deadline=None, suppress_health_check=UNHURRIED)
@given(st.binary(max_size=300), st.sampled_from([".csv", ".parquet", ".npz", ".tsv"]))
def test_any_bytes_give_a_log_or_a_log_error(ur5, tmp_path, content, suffix):
    path = tmp_path / f"x{suffix}"
    path.write_bytes(content)
    with pytest.raises(LogError):
        read_log(path, ur5)


@settings(max_examples=40, deadline=None, suppress_health_check=UNHURRIED)
@given(st.integers(0, 5000), st.binary(min_size=1, max_size=8))
def test_damage_anywhere_in_a_csv_gives_a_log_or_a_log_error(ur5, tmp_path, where, junk):
    data = bytearray(text_of(ur5.joints).encode())
    where %= len(data)
    data[where : where + len(junk)] = junk
    path = tmp_path / "x.csv"
    path.write_bytes(bytes(data))
    try:
        assert isinstance(read_log(path, ur5), Log)
    except LogError as error:
        assert "\n" not in str(error)


def test_a_long_csv_is_read_fast(ur5, tmp_path):
    rng = np.random.default_rng(0)
    samples = rng.normal(size=(3, 20_000, ur5.n))
    path = write_log(
        Log(ur5.joints, np.arange(20_000) * 1e-3, samples[0], samples[1], samples[2]), tmp_path / "x.csv"
    )
    read_log(path, ur5)  # the first call imports pyarrow
    start = clock.process_time()
    read_log(path, ur5)
    assert clock.process_time() - start < 0.5


@pytest.mark.parametrize(
    ("signals", "delimiter"),
    [(("position", "effort"), ","), (("position", "velocity", "effort"), ","), (("position", "effort"), ";")],
)
def test_the_line_of_names_that_a_table_lacks_is_printed_and_mends_it(ur5, tmp_path, signals, delimiter):
    whole = text_of(ur5.joints, signals=signals, delimiter=delimiter)
    rows = whole.partition("\n")[2]
    with pytest.raises(LogError, match="the first line holds numbers") as caught:
        read_log(write(tmp_path / "bare.csv", rows), ur5)
    line = str(caught.value).rpartition("add the first line ")[2]
    log = read_log(write(tmp_path / "mended.csv", f"{line}\n{rows}"), ur5)
    np.testing.assert_array_equal(log.effort, read_log(write(tmp_path / "whole.csv", whole), ur5).effort)
    assert (log.velocity is None) == ("velocity" not in signals)


@pytest.mark.parametrize(
    ("count", "said"),
    [(7, r"efforts are needed too.*add the first line time,position\.shoulder_pan_joint"),
     (9, "a first line with a name for each of its 9 columns, such as time,position.<joint>,effort.<joint>")],
)  # fmt: skip
def test_a_table_of_numbers_says_how_to_go_on(ur5, tmp_path, count, said):
    rows = "".join(",".join(str(k + c) for c in range(count)) + "\n" for k in range(5))
    with pytest.raises(LogError, match=said):
        read_log(write(tmp_path / "bare.csv", rows), ur5)
