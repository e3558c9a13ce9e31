"""A server for browsers of this machine only: the page of a scene, and its changes as server-sent events.

meshcat's own server listens on every interface of the machine. This one listens on 127.0.0.1 and answers only requests
for "127.0.0.1" or "localhost": a foreign page cannot reach it through another host name. It runs in threads of this
process and ends with it.
"""

from __future__ import annotations

import json
import os
import queue
import sys
import threading
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from exoid.errors import BadArgumentError

from .commands import Command

LOOPBACK = "127.0.0.1"

MOST_CONNECTIONS = 64
"""Largest number of connections at once; an open page needs one, and a second one while it loads."""


class SceneServer(AbstractContextManager["SceneServer"]):
    """Serves a scene on 127.0.0.1 until it is closed; made by :meth:`.Scene.serve`."""

    # url: Address for a browser.
    # port: Port that it listens on.

    def __init__(
        self,
        page: Callable[[], str],
        pose: Callable[[Mapping[str, float]], list[Command]],
        port: int | None = None,
        patience: float = 10.0,
    ) -> None:
        """Start listening; ``patience`` [s] is that with a connection that sends no request, or takes no data."""
        self.page, self._pose = page, pose
        self._listeners: set[queue.Queue[str | None]] = set()
        self._latest: dict[tuple[object, ...], Command] = {}
        self._lock = threading.Lock()
        self._server = _bind(port)
        self._server.scene_server = self
        self._server.patience = patience
        self.port = int(self._server.server_address[1])
        self.url = f"http://{LOOPBACK}:{self.port}/"
        self._thread = threading.Thread(target=self._server.serve_forever, args=(0.1,), name="exoid view", daemon=True)
        self._thread.start()

    def pose(self, angles: Mapping[str, float]) -> None:
        """Move joints to angles in every open page, and all other joints to zero."""
        self.send(self._pose(angles))

    def send(self, commands: list[Command]) -> None:
        """Send drawing commands to every open page."""
        text = json.dumps(commands, separators=(",", ":"))
        with self._lock:
            self._latest |= {(c["type"], c.get("path"), c.get("property")): c for c in commands}
            for listener in self._listeners:
                listener.put(text)

    def wait(self) -> None:
        """Wait until the server is closed or Ctrl-C is pressed."""
        try:
            while self._thread.is_alive():
                self._thread.join(0.5)
        except KeyboardInterrupt:
            pass

    def close(self) -> None:
        """Stop listening and end all threads."""
        with self._lock:
            for listener in self._listeners:
                listener.put(None)
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def subscribe(self) -> queue.Queue[str | None]:
        """Register a page for changes of the scene."""
        listener: queue.Queue[str | None] = queue.Queue()
        with self._lock:
            listener.put(json.dumps(list(self._latest.values())))
            self._listeners.add(listener)
        return listener

    def unsubscribe(self, listener: queue.Queue[str | None]) -> None:
        """End the registration of a page."""
        with self._lock:
            self._listeners.discard(listener)

    def __exit__(self, *_: object) -> None:
        self.close()


class _Server(ThreadingHTTPServer):
    """Serves at most :data:`MOST_CONNECTIONS` at once, each in a thread; others are closed unanswered."""

    daemon_threads = True
    block_on_close = False
    request_queue_size = MOST_CONNECTIONS  # beyond the queue, clients try again after seconds
    allow_reuse_address = os.name == "posix"  # on Windows it would let another program take the port
    scene_server: SceneServer
    patience: float

    def __init__(self, address: tuple[str, int], handler: type[BaseHTTPRequestHandler]) -> None:
        self._free = threading.BoundedSemaphore(MOST_CONNECTIONS)
        super().__init__(address, handler)

    def process_request(self, request: Any, client_address: Any) -> None:  # noqa: ANN401 - as in the standard library
        """Start a thread for a connection, if one is free."""
        if self._free.acquire(blocking=False):
            super().process_request(request, client_address)
        else:
            self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:  # noqa: ANN401
        """Serve a connection in its thread."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._free.release()

    def handle_error(self, request: Any, client_address: Any) -> None:  # noqa: ANN401
        """Ignore a browser that hangs up; report any other error as the standard library does."""
        if not isinstance(sys.exc_info()[1], OSError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    """Answers "/" with the page, and "/events" with commands as server-sent events."""

    server: _Server
    server_version = "exoid"
    sys_version = ""

    def setup(self) -> None:
        """Take the patience of the server as the timeout of the connection."""
        super().setup()
        self.connection.settimeout(self.server.patience)

    def do_GET(self) -> None:
        """Answer a request."""
        host = (self.headers.get("Host") or "").rsplit(":", 1)[0]
        if host not in (LOOPBACK, "localhost"):
            self.send_error(HTTPStatus.FORBIDDEN)
        elif self.path == "/":
            self._answer("text/html; charset=utf-8", self.server.scene_server.page().encode())
        elif self.path == "/events":
            self._answer("text/event-stream")
            self._stream()
        else:
            self.send_error(HTTPStatus.NOT_FOUND)

    def log_message(self, format: str, *args: object) -> None:
        """Log nothing."""

    def _answer(self, kind: str, body: bytes = b"") -> None:
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", kind)
        self.send_header("Cache-Control", "no-store")
        if body:
            self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def _stream(self) -> None:
        """Send commands as they come, until the server ends or the page is closed."""
        scene_server = self.server.scene_server
        listener = scene_server.subscribe()
        try:
            while True:
                try:
                    text = listener.get(timeout=5.0)  # [s], after which a closed browser is noticed
                except queue.Empty:
                    self.wfile.write(b": still here\n\n")
                    continue
                message = "event: end\ndata:\n\n" if text is None else f"data: {text}\n\n"
                self.wfile.write(message.encode())
                if text is None:
                    break
        except OSError:  # the browser has closed
            pass
        finally:
            scene_server.unsubscribe(listener)


def _bind(port: int | None) -> _Server:
    """Listen on a port; for None on port 7000 or, if that is taken, on any free port."""
    for number in (7000, 0) if port is None else (port,):
        try:
            return _Server((LOOPBACK, number), _Handler)
        except OverflowError:
            raise BadArgumentError(
                f"port {number}", remedy="choose one from 1 to 65535, or 0 for any that is free"
            ) from None
        except OSError as problem:
            reason = problem.strerror or str(problem)
    raise BadArgumentError(f"cannot listen on port {number} ({reason})", remedy="choose another port")
