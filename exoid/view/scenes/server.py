"""A server of the page of a scene, for browsers of this machine only.

meshcat's own server listens on every interface of the machine. This one listens on 127.0.0.1 and answers only requests
for "127.0.0.1" or "localhost": a foreign page cannot reach it through another host name. It runs in threads of this
process and ends with it. A file would not do: browsers in a sandbox, such as Ubuntu's, open no file of /tmp.
"""

from __future__ import annotations

import os
import sys
import threading
from contextlib import AbstractContextManager
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from exoid.errors import BadArgumentError

LOOPBACK = "127.0.0.1"


class SceneServer(AbstractContextManager["SceneServer"]):
    """Serves a page on 127.0.0.1 until it is closed; made by :meth:`.Scene.serve`.

    Attributes:
        url: Address for a browser.
        port: Port that it listens on.
    """

    def __init__(self, page: str, port: int | None = None) -> None:
        """Start listening."""
        self._server = _bind(port)
        self._server.page = page.encode()
        self.port = int(self._server.server_address[1])
        self.url = f"http://{LOOPBACK}:{self.port}/"
        self._thread = threading.Thread(target=self._server.serve_forever, args=(0.1,), name="exoid view", daemon=True)
        self._thread.start()

    def wait(self) -> None:
        """Wait until the server is closed or Ctrl-C is pressed."""
        try:
            while self._thread.is_alive():
                self._thread.join(0.5)
        except KeyboardInterrupt:
            pass

    def close(self) -> None:
        """Stop listening."""
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def __exit__(self, *_: object) -> None:
        self.close()


class _Server(ThreadingHTTPServer):
    """Serves each connection in a thread."""

    daemon_threads = True
    block_on_close = False
    allow_reuse_address = os.name == "posix"  # on Windows it would let another program take the port
    page: bytes

    def handle_error(self, request: Any, client_address: Any) -> None:  # noqa: ANN401 - as in the standard library
        """Ignore a browser that hangs up; report any other error as the standard library does."""
        if not isinstance(sys.exc_info()[1], OSError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    """Answers "/" with the page."""

    server: _Server
    server_version = "exoid"
    sys_version = ""
    timeout = 10.0  # [s], after which a connection that sends no request, or takes no data, is closed

    def do_GET(self) -> None:
        """Answer a request."""
        host = (self.headers.get("Host") or "").rsplit(":", 1)[0]
        if host not in (LOOPBACK, "localhost"):
            self.send_error(HTTPStatus.FORBIDDEN)
            return
        if self.path != "/":
            self.send_error(HTTPStatus.NOT_FOUND)
            return
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", "text/html; charset=utf-8")
        self.send_header("Cache-Control", "no-store")
        self.send_header("Content-Length", str(len(self.server.page)))
        self.end_headers()
        self.wfile.write(self.server.page)

    def log_message(self, format: str, *args: object) -> None:
        """Log nothing."""


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
