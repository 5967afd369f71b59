"""A single wild sample does not change a verdict, and every command that leaves it out says so."""

import pytest


@pytest.fixture(scope="module")
def wild(log, tmp_path_factory):
    lines = log.read_text().splitlines()
    cells = lines[901].split(",")
    cells[lines[0].split(",").index("position.joint2")] = "100.0"
    lines[901] = ",".join(cells)
    file = tmp_path_factory.mktemp("wild") / "wild.csv"
    file.write_text("\n".join(lines) + "\n")
    return file


def test_discover_finds_the_same_and_says_how_many_it_left_out(cdia, log, wild):
    plain = cdia("discover", log, "--robot", "double_pendulum", "--json", "-").json
    found = cdia("discover", wild, "--robot", "double_pendulum", "--json", "-").json
    for key in ("effect", "joints"):
        assert [e[key] for e in found["effects"]] == [e[key] for e in plain["effects"]]
    assert found["verdict"] == plain["verdict"]
    assert "1 sample that no motion makes" in found["record"]["logs"][0]["notes"][-1]
    said = cdia("discover", wild, "--robot", "double_pendulum", "--no-check")
    assert "1 sample that no motion makes: position of joint2 is 100 at t = 9 s" in " ".join(said.out.split())


def test_check_names_it(cdia, wild):
    out = " ".join(cdia("check", wild, "--robot", "double_pendulum").out.split())
    assert "joint2" in out and "100 at t = 9 s" in out
