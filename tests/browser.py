"""A real Chromium without a window, driven by its DevTools protocol: what a page shows, says, and asks the network for.

Software draws its WebGL, so that no graphics card is needed. Names other than this machine's do not resolve, so that a
request which would leave the machine fails as it would without a network: that is always in :attr:`Page.problems`, and
the request is in :attr:`Page.requests`, unless a frame in a process of its own makes it before Chromium reports on it.
"""

import base64
import io
import itertools
import json
import shutil
import subprocess
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

ARTEFACTS = Path(__file__).parents[1] / "artefacts" / "screenshots"
"""Where screenshots are kept to be looked at; not under version control."""

FLAGS = (
    *("--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader"),
    *("--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--disable-background-networking"),
    *("--disable-component-update", "--disable-default-apps", "--disable-dev-shm-usage"),
    *("--disable-extensions", "--disable-sync", "--no-default-browser-check", "--no-first-run"),
    *("--no-pings", "--hide-scrollbars", "--mute-audio"),
    *("--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1", "--remote-debugging-port=0"),
    *("about:blank",),
)

LISTEN = (
    ("Runtime.enable", {}),
    ("Log.enable", {}),
    ("Network.enable", {}),
    ("Target.setAutoAttach", {"autoAttach": True, "waitForDebuggerOnStart": True, "flatten": True}),
)
"""Commands after which a page, or a frame in a process of its own, says everything."""

READY = "window.exoid !== undefined && window.exoid.viewer.renderer.info.render.frame > 0"
"""Whether a scene is drawn."""

LONGEST = 60.0
"""To wait for anything [s]."""


class Browser:
    """A running Chromium."""

    def __init__(self, port):
        self.port = port

    @contextmanager
    def page(self, url, size=(800, 600)):
        """Open an address, wait until it is loaded, and close it afterwards."""
        from websockets.sync.client import connect  # noqa: PLC0415 - tests that need no browser need no websockets

        with connect(f"ws://127.0.0.1:{self.port[0]}{self.port[1]}", max_size=None) as socket:
            target = Page(socket, None).send("Target.createTarget", url="about:blank")["targetId"]
            attached = Page(socket, None).send("Target.attachToTarget", targetId=target, flatten=True)
            page = Page(socket, attached["sessionId"])
            page.send("Page.enable")
            page.listen()
            page.send(
                "Emulation.setDeviceMetricsOverride",
                width=size[0],
                height=size[1],
                deviceScaleFactor=1,
                mobile=size[0] < 600,
            )
            page.send("Page.navigate", url=str(url))
            page.wait_for("document.readyState === 'complete'")
            yield page
            Page(socket, None).send("Target.closeTarget", targetId=target)


class Page:
    """An open page.

    Attributes:
        problems: Errors and warnings of its console, uncaught exceptions, and refused requests.
        requests: Addresses it asked for, data and blobs in the page itself left out.
    """

    numbers = itertools.count(1)

    def __init__(self, socket, session):
        self._socket = socket
        self._session = session
        self._sessions = {session}
        self.problems = []
        self.requests = []

    def send(self, method, **parameters):
        """Send a command and wait for its result."""
        number = self._post(self._session, method, parameters)
        until = time.monotonic() + LONGEST
        while time.monotonic() < until:
            answer = json.loads(self._socket.recv(timeout=LONGEST))
            if answer.get("id") == number:
                assert "error" not in answer, (method, answer["error"])
                return answer["result"]
            self._note(answer)
        raise TimeoutError(method)

    def listen(self):
        """Hear what the page and the frames in it say, those in processes of their own too."""
        for method, parameters in LISTEN:
            self.send(method, **parameters)

    def evaluate(self, script):
        """Value of an expression in the page."""
        answer = self.send("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in answer, answer["exceptionDetails"]
        return answer["result"].get("value")

    def wait_for(self, script):
        """Wait until an expression is true."""
        until = time.monotonic() + LONGEST
        while not self.evaluate(script):
            if time.monotonic() > until:
                raise TimeoutError(f"{script} never became true; {self.problems}")
            time.sleep(0.05)

    def screenshot(self, name=None):
        """Picture of the page, (height, width, 3) in 0 to 255; kept under a name if one is given."""
        frames = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))"
        self.evaluate(frames)
        content = base64.b64decode(self.send("Page.captureScreenshot", format="png")["data"])
        if name is not None:
            ARTEFACTS.mkdir(parents=True, exist_ok=True)
            (ARTEFACTS / f"{name}.png").write_bytes(content)
        return np.asarray(Image.open(io.BytesIO(content)).convert("RGB"))

    def _post(self, session, method, parameters):
        number = next(self.numbers)
        message = {"id": number, "method": method, "params": parameters}
        self._socket.send(json.dumps(message | ({"sessionId": session} if session else {})))
        return number

    def _note(self, event):
        if event.get("sessionId") not in self._sessions:
            return
        kind, details = event.get("method"), event.get("params", {})
        if kind == "Target.attachedToTarget" and self._session is not None:
            self._sessions.add(details["sessionId"])
            for method, parameters in (*LISTEN, ("Runtime.runIfWaitingForDebugger", {})):
                self._post(details["sessionId"], method, parameters)
        elif kind == "Runtime.exceptionThrown":
            self.problems.append(details["exceptionDetails"].get("exception", details["exceptionDetails"]))
        elif kind == "Runtime.consoleAPICalled" and details["type"] in ("error", "warning", "assert"):
            self.problems.append([argument.get("value", argument.get("description")) for argument in details["args"]])
        elif kind == "Log.entryAdded" and details["entry"]["level"] in ("error", "warning"):
            self.problems.append(details["entry"]["text"])
        elif kind == "Network.requestWillBeSent" and not details["request"]["url"].startswith(("data:", "blob:")):
            self.requests.append(details["request"]["url"])


@contextmanager
def chromium():
    """Start a Chromium with a fresh profile; skip the test, and say so, where there is none."""
    program = next(
        (found for name in ("chromium", "chromium-browser", "google-chrome") if (found := shutil.which(name))), None
    )
    if program is None:
        pytest.skip("no Chromium on this machine (Debian: apt-get install chromium)")
    pytest.importorskip("websockets.sync.client", reason="pip install websockets, which speaks to Chromium")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        process = subprocess.Popen(
            [program, f"--user-data-dir={profile}", *FLAGS], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        try:
            yield Browser(_port(Path(profile) / "DevToolsActivePort", process))
        finally:
            process.terminate()
            try:
                process.wait(10.0)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def distance_to(picture, colour):
    """How far each pixel is from a colour "#rrggbb", largest of the three channels, (height, width)."""
    target = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)])
    return np.abs(picture.astype(int) - target).max(axis=-1)


def _port(file, process):
    """Port of the DevTools, which Chromium writes into its profile, with the path of the browser's own socket."""
    until = time.monotonic() + LONGEST
    while time.monotonic() < until:
        assert process.poll() is None, "Chromium ended at once"
        if file.exists() and len(lines := file.read_text().split()) == 2:
            return tuple(lines)
        time.sleep(0.05)
    raise TimeoutError("Chromium does not answer")
