"""Files of the app: what was dropped, where meshes go, and what is left behind."""

import asyncio
import subprocess
import sys
import zipfile

import pytest

from cdia_pin import CdiaError
from cdia_pin.app.dropped import inside, place_meshes, sort_dropped
from cdia_pin.app.inputs import Request
from cdia_pin.app.log_columns import columns_of
from cdia_pin.app.scratch import PREFIX, Scratch
from cdia_pin.app.workbench import Workbench
from cdia_pin.resources import logs_dir

URDF = '<robot name="a"><link name="b"><visual><geometry><mesh filename="{}"/></geometry></visual></link></robot>'


def test_dropped_files_are_told_apart(tmp_path):
    for name, text in {
        "arm.urdf": URDF.format("x.stl"),
        "run.csv": "time,q1\n",
        "gains.json": '{"b": 10.0}',
        "better.json": '{"schema": "cdia-model/1"}',
        "x.stl": "",
    }.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "check.json").write_text('{"schema": "cdia-check/1"}')
    found = sort_dropped(tmp_path)
    assert (found.robot.name, found.log.name, found.model.name) == ("arm.urdf", "run.csv", "better.json")
    assert found.gains == {"b": 10.0}
    assert [m.name for m in found.meshes] == ["x.stl"]


@pytest.mark.parametrize(
    "text",
    ['{"fps": 30, "features": {"a": 1}}', '{"b": "ten"}', '{"b": true}', '{"b": {"value": "ten"}}', "{}"],
)
def test_a_document_that_is_not_of_numbers_holds_no_gains(tmp_path, text):
    (tmp_path / "info.json").write_text(text)
    with pytest.raises(CdiaError, match="nothing to use"):
        sort_dropped(tmp_path)
    (tmp_path / "gains.json").write_text('{"b": {"value": 10.0, "tolerance": 1}}')
    assert sort_dropped(tmp_path).gains == {"b": {"value": 10.0, "tolerance": 1}}


def test_texts_and_hidden_files_beside_a_log_are_no_logs(tmp_path):
    (tmp_path / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.10)\n")
    with pytest.raises(CdiaError, match="nothing to use"):
        sort_dropped(tmp_path)
    (tmp_path / "run.txt").write_text("time q1 q2\n0 1 2\n")
    assert sort_dropped(tmp_path).log.name == "run.txt"
    (tmp_path / "__MACOSX").mkdir()
    for name in ("a.csv", "._a.csv", "._a.zip", "__MACOSX/b.csv"):
        (tmp_path / name).write_text("time,q1\n")
    assert sort_dropped(tmp_path).log.name == "a.csv"


def test_a_zip_file_is_unpacked_and_cannot_write_elsewhere(tmp_path):
    for name, member in (("good", "arm/arm.urdf"), ("bad", "../arm.urdf")):
        folder = tmp_path / name
        folder.mkdir()
        with zipfile.ZipFile(folder / "robot.zip", "w") as packed:
            packed.writestr(member, URDF.format("x.stl"))
    assert sort_dropped(tmp_path / "good").robot.name == "arm.urdf"
    with pytest.raises(CdiaError, match="path"):
        sort_dropped(tmp_path / "bad")
    assert not (tmp_path / "arm.urdf").exists()


@pytest.mark.parametrize("name", ["../a", "/a", "a/../../b", "", "a\\..\\b", "a\0b"])
def test_a_dropped_file_stays_in_its_folder(tmp_path, name):
    with pytest.raises(CdiaError, match="path"):
        inside(tmp_path, name)


def test_what_is_not_clear_is_refused(tmp_path):
    (tmp_path / "note.md").write_text("")
    with pytest.raises(CdiaError, match="nothing to use in note"):
        sort_dropped(tmp_path)
    for name in ("a.urdf", "b.urdf"):
        (tmp_path / name).write_text(URDF.format("x.stl"))
    with pytest.raises(CdiaError, match="more than one robot was dropped"):
        sort_dropped(tmp_path)


@pytest.mark.parametrize("name", ["bag_0.db3", "bag_0.db3.zstd"])
def test_the_folder_of_a_bag_is_a_log(tmp_path, name):
    (tmp_path / "bag").mkdir()
    for each in (name, "metadata.yaml"):
        (tmp_path / "bag" / each).write_text("")
    assert sort_dropped(tmp_path).log == tmp_path / "bag"


@pytest.mark.parametrize("method", [zipfile.ZIP_DEFLATED, zipfile.ZIP_LZMA, zipfile.ZIP_BZIP2])
def test_a_damaged_zip_file_is_refused(tmp_path, method):
    with zipfile.ZipFile(tmp_path / "A.ZIP", "w", method) as packed:
        packed.writestr("run.csv", "time,q1\n" * 100)
    whole = (tmp_path / "A.ZIP").read_bytes()
    assert sort_dropped(tmp_path).log.name == "run.csv"
    for at in range(37, 50):  # what follows the name of the member
        (tmp_path / "b").mkdir(exist_ok=True)
        (tmp_path / "b" / "A.ZIP").write_bytes(whole[:at] + b"\xff" * 9 + whole[at + 9 :])
        with pytest.raises(CdiaError, match="not a zip file that can be read"):
            sort_dropped(tmp_path / "b")


def test_a_mesh_below_another_mesh_is_left_out(tmp_path):
    meshes = "".join(URDF.format(name)[16:-8] for name in ("a/b.stl", "a/b.stl/c.stl"))
    (tmp_path / "arm.urdf").write_text(f'<robot name="a">{meshes}</robot>')
    for name in ("b.stl", "c.stl"):
        (tmp_path / name).write_text(name)
    place_meshes(tmp_path / "arm.urdf", [tmp_path / "b.stl", tmp_path / "c.stl"])
    assert (tmp_path / "a" / "b.stl").read_text() == "b.stl"


def test_drops_are_bounded_and_a_refused_one_leaves_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr("cdia_pin.app.drops.MOST_FILES", 2)
    monkeypatch.setattr("cdia_pin.app.drops.UNPACKED", 1)
    bench = Workbench(tmp_path / "session")
    for name in ("a.md", "b.md"):
        file = bench.drops.place("drop", name)
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("x")
    with pytest.raises(CdiaError, match="2 files at most"):
        bench.drops.place("other", "c.md")
    asyncio.run(bench.take_dropped("drop"))
    assert "nothing to use in a.md" in bench.runner.wrong
    assert not (tmp_path / "session" / "drop").exists()
    bench.drops.place("other", "c.md")
    with pytest.raises(CdiaError, match="1 MB at most"):
        bench.drops.count("other", 2 * 10**6)


def test_a_page_cannot_name_a_folder_elsewhere(tmp_path):
    bench = Workbench(tmp_path / "session")
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "arm.urdf").write_text(URDF.format("x.stl"))
    for name in (str(tmp_path / "other"), "../other", "none"):
        asyncio.run(bench.take_dropped(name))
        assert bench.runner.wrong and bench.desk.form.robot == ""
    assert (tmp_path / "other" / "arm.urdf").exists()


@pytest.mark.parametrize("address", ["package://arm/meshes/visual/x.stl", "meshes/visual/x.stl"])
def test_meshes_go_where_the_urdf_looks_for_them(tmp_path, address):
    urdf = tmp_path / "arm.urdf"
    urdf.write_text(URDF.format(address))
    for folder in ("collision", "visual"):
        (tmp_path / "drop" / folder).mkdir(parents=True)
        (tmp_path / "drop" / folder / "x.stl").write_text(folder)
    place_meshes(urdf, sorted((tmp_path / "drop").rglob("*.stl")))
    assert (tmp_path / address.removeprefix("package://")).read_text() == "visual"


def test_a_mesh_is_never_put_outside(tmp_path):
    folder = tmp_path / "robot"
    folder.mkdir()
    (folder / "arm.urdf").write_text(URDF.format("package://../x.stl"))
    (folder / "x.stl").write_text("")
    place_meshes(folder / "arm.urdf", [folder / "x.stl"])
    assert not (tmp_path / "x.stl").exists()


def test_names_of_a_log_are_proposed_where_their_number_fits(tmp_path):
    log = tmp_path / "run.csv"
    log.write_text("time,position.a,position.b,current.a,current.b\n0,1,2,3,4\n1,1,2,3,4\n")
    columns = columns_of(Request("", log), ("one", "two"))
    assert columns.currents
    assert columns.proposed(("one", "two")) == {"one": "a", "two": "b"}
    assert columns.proposed(("a", "two")) == {"two": "b"}
    assert columns.proposed(("one", "two", "three")) == {}
    assert columns_of(Request("", tmp_path / "none.csv"), ("one",)) is None
    assert not columns_of(Request("", logs_dir() / "demo_ur5.csv"), ("elbow_joint",)).currents


def test_the_next_start_removes_what_a_kill_has_left(tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    living = Scratch()
    script = (
        f"import tempfile; tempfile.tempdir = {str(tmp_path)!r}\n"
        "from cdia_pin.app.scratch import Scratch\n"
        "made = Scratch(); (made.folder() / 'run.csv').write_text('x')\n"
        "import os; print(made.path); os.kill(os.getpid(), 9)"
    )
    said = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False).stdout
    (dead,) = (p for p in tmp_path.glob(PREFIX + "*") if p != living.path)
    assert str(dead) == said.strip() and list(dead.rglob("run.csv"))
    other = Scratch()
    assert set(tmp_path.glob(PREFIX + "*")) == {living.path, other.path}
    other.close()
    living.close()
    assert not list(tmp_path.iterdir())
