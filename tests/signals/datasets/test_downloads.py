"""A download that is killed leaves nothing that a later one would take for the file."""

from __future__ import annotations

import hashlib
import os
import signal
import subprocess
import sys
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

CONTENT = b"time,pos1\n" + b"0.0,1.0\n" * 50_000

FETCH = """
import sys
from exoid.signals.datasets import dfki
dfki.URL, dfki.SHA256 = sys.argv[1:]
print(dfki.recording_path())
"""


@pytest.fixture
def server():
    """Sends half of the file to the first who asks, and then nothing; all of it to later ones."""
    stalled, over = threading.Event(), threading.Event()

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self):  # the name that the library calls
            first = not stalled.is_set()
            self.send_response(200)
            self.send_header("Content-Length", str(len(CONTENT)))
            self.end_headers()
            self.wfile.write(CONTENT[: len(CONTENT) // 2] if first else CONTENT)
            if first:
                self.wfile.flush()
                stalled.set()
                over.wait(60.0)

        def log_message(self, *_):
            pass

    running = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=running.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{running.server_port}/recording.csv", stalled
    over.set()
    running.shutdown()
    running.server_close()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the cache is found by XDG_CACHE_HOME")
def test_a_download_that_is_killed_halfway_is_made_again(server, tmp_path):
    url, stalled = server
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path), "EXOID_DATA_DIR": ""}
    command = [sys.executable, "-c", FETCH, url, hashlib.sha256(CONTENT).hexdigest()]
    first = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    assert stalled.wait(60.0)
    first.send_signal(signal.SIGKILL)
    assert first.communicate(timeout=30)[0] == b""
    assert not list(tmp_path.rglob("*.csv")), "half a file has the name of a whole one"
    second = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120, check=True)
    assert Path(second.stdout.strip()).read_bytes() == CONTENT
