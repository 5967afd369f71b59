"""Ctrl-C ends a command, also where the interrupt itself gets lost."""

import signal
import subprocess
import time

from tests.processes import python

SWALLOWED = """
import signal, sys, time
from cdia_pin.cli.interrupts import insistent

class Deaf:
    def __del__(self):
        signal.raise_signal(signal.SIGINT)  # an exception in a destructor is ignored

try:
    with insistent():
        try:
            Deaf()
            print("went on", flush=True)
            for _ in range(300):
                time.sleep(0.1)
        finally:
            begin = time.monotonic()
            while time.monotonic() < begin + 1.2:  # longer than it takes to be interrupted again
                time.sleep(0.05)
            print("cleaned up", flush=True)
except KeyboardInterrupt:
    time.sleep(0.8)
    print("interrupted", flush=True)
"""

IN_TEXT = """
import signal, sys
from cdia_pin.cli.interrupts import insistent

try:
    with insistent():
        exec("signal.raise_signal(signal.SIGINT)")
except KeyboardInterrupt:
    sys.exit(3)
"""

ANSWERED = """
import signal, time
from cdia_pin.cli.interrupts import insistent, until_interrupted

with insistent():
    with until_interrupted():
        signal.raise_signal(signal.SIGINT)
    begin = time.monotonic()
    while time.monotonic() < begin + 1.2:  # a slow machine on its way out
        time.sleep(0.05)
    print("ended")
"""

TELLING = """
import sys
from importlib import import_module

module = import_module("cdia_pin.dynamics.simulate")
run_plant = module.run_plant

def told(*arguments, **options):
    print("simulating", flush=True)
    return run_plant(*arguments, **options)

module.run_plant = told
from cdia_pin.cli import main
sys.exit(main(sys.argv[1:]))
"""


def started(*program):
    command = python(*program)
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def test_an_interrupt_that_got_lost_comes_again_and_lets_clean_up():
    done = subprocess.run(python("-c", SWALLOWED), check=False, capture_output=True, text=True, timeout=60)
    assert done.stdout.split("\n") == ["went on", "cleaned up", "interrupted", ""], done.stderr
    assert done.stderr == ""


def test_an_interrupt_inside_executed_text_does_not_decide_the_exit_code(tmp_path):
    (tmp_path / "in_text.py").write_text(IN_TEXT)
    command = python("-m", "in_text")
    done = subprocess.run(command, cwd=tmp_path, check=False, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (3, "")


def test_an_interrupt_that_was_answered_does_not_come_again():
    done = subprocess.run(python("-c", ANSWERED), check=False, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (0, "ended\n", "")


def test_a_command_that_is_interrupted_says_so(tmp_path):
    arguments = ["simulate", "--robot", "ur5", "--duration", "1000", "--out", str(tmp_path / "run.csv")]
    running = started("-c", TELLING, *arguments)
    assert running.stdout.readline() == "simulating\n"
    time.sleep(0.5)
    running.send_signal(signal.SIGINT)
    assert running.wait(60) == 130
    assert running.stderr.read().splitlines()[-1] == "cdia: error: interrupted"


def test_a_view_that_is_interrupted_ends_without_an_error():
    running = started("-m", "cdia_pin", "view", "--simulate", "--robot", "ur5", "--no-open")
    assert "http" in running.stdout.readline()
    running.send_signal(signal.SIGINT)
    assert running.wait(60) == 0
    assert "Traceback" not in running.stderr.read()
