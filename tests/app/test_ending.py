"""The app in a process of its own: closed to others, and nothing is left behind however it ends."""

import http.cookiejar
import os
import re
import signal
import subprocess
import urllib.error
import urllib.request

import pytest

from tests.processes import python

pytest.importorskip("nicegui")


@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 143)]
)
def test_the_app_is_closed_to_others_and_cleans_up(tmp_path, number, code):
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTEST")} | {
        "TMPDIR": str(tmp_path)
    }
    command = python("-m", "cdia_pin", "app", "--no-open", "--port", "0")
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment
    )
    try:
        found = re.search(r"(http://127\.0\.0\.1:\d+)/\?token=\S+", process.stdout.readline())
        for path in ("/", "/live", "/cdia/style.css", "/_nicegui_ws/socket.io/?EIO=4&transport=polling"):
            with pytest.raises(urllib.error.HTTPError, match="403"):
                urllib.request.urlopen(found[1] + path)
        cookies = urllib.request.HTTPCookieProcessor(http.cookiejar.CookieJar())
        assert urllib.request.build_opener(cookies).open(found[0]).status == 200
        process.send_signal(number)
        assert process.wait(60) == code
        assert "Traceback" not in process.stdout.read()
    finally:
        process.kill()
    assert not list(tmp_path.glob("cdia-*"))
