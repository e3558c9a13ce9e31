"""The scene's server is reached from this machine only, and leaves nothing behind."""

import http.client
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from contextlib import suppress

import psutil
import pytest
from drawings import scene_of

import exoid
from exoid import ExoidError
from exoid.view import scene
from exoid.view.scenes.server import _Handler as Handler


@pytest.fixture(scope="module")
def drawn():
    return scene(exoid.load_leg("bleex"))


def get(port, path="/", host=None):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
    connection.request("GET", path, headers={"Host": host or f"127.0.0.1:{port}"})
    return connection.getresponse()


def listening(process):
    """Addresses on which a process and its children listen, of either family."""
    everyone = [process, *process.children(recursive=True)]
    connections = [c for each in everyone for c in each.net_connections("inet")]
    return {c.laddr for c in connections if c.status == psutil.CONN_LISTEN}


def test_the_page_is_served_and_is_the_scene(drawn):
    with drawn.serve(0) as server:
        response = get(server.port)
        page = response.read().decode()
        assert response.status == 200
        assert scene_of(page)["title"] == drawn.title
        assert server.url == f"http://127.0.0.1:{server.port}/"
        assert get(server.port, "/etc/passwd").status == 404


def test_only_the_loopback_address_is_listened_on(drawn):
    """Over IPv4 and IPv6, in this process and any child of it."""
    before = listening(psutil.Process())
    with drawn.serve(0) as server:
        added = listening(psutil.Process()) - before
        assert [(address.ip, address.port) for address in added] == [("127.0.0.1", server.port)]
        for family, address in own_addresses():
            with socket.socket(family) as attempt:
                attempt.settimeout(2.0)
                with pytest.raises(OSError, match=r"refused|timed out|unreachable"):
                    attempt.connect((address, server.port))
    assert listening(psutil.Process()) == before


def own_addresses():
    """This machine's addresses that others could reach, and IPv6's loopback, on which nothing should listen either."""
    entries = [entry for addresses in psutil.net_if_addrs().values() for entry in addresses]
    found = [(entry.family, entry.address.split("%")[0]) for entry in entries]
    reachable = [(family, address) for family, address in found if not address.startswith(("127.", "::1", "fe80"))]
    families = (socket.AF_INET, socket.AF_INET6)
    return [*(pair for pair in reachable if pair[0] in families), *([(socket.AF_INET6, "::1")] * socket.has_ipv6)]


def test_a_foreign_page_cannot_reach_it_through_another_host_name(drawn):
    with drawn.serve(0) as server:
        assert get(server.port, host=f"localhost:{server.port}").status == 200
        assert get(server.port, host="evil.example").status == 403


def test_closing_ends_its_thread_and_frees_the_port(drawn):
    before = set(threading.enumerate())
    server = drawn.serve(0)
    server.close()
    assert set(threading.enumerate()) == before
    with drawn.serve(server.port) as again:
        assert again.port == server.port


def test_a_port_in_use_is_named_and_the_default_gives_way(drawn):
    with drawn.serve(0) as server:
        with pytest.raises(ExoidError, match=f"cannot listen on port {server.port}"):
            drawn.serve(server.port)
        with drawn.serve() as first, drawn.serve() as second:
            assert len({server.port, first.port, second.port}) == 3
    with pytest.raises(ExoidError, match="port 70000"):
        drawn.serve(70000)


@pytest.mark.slow
def test_the_command_listens_on_loopback_until_ctrl_c_and_ends_cleanly():
    command = [sys.executable, "-m", "exoid.cli", "view", "bleex", "--no-browser", "--port", "0", "--json"]
    program = "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler); "
    program += f"sys.argv = {['exoid', *command[3:]]!r}; from exoid.cli import main; main()"
    running = subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        said = json.loads(running.stdout.readline())
        process = psutil.Process(running.pid)
        assert {(address.ip, address.port) for address in listening(process)} == {("127.0.0.1", said["port"])}
        assert process.children(recursive=True) == []
        assert get(said["port"]).status == 200
        os.kill(running.pid, signal.SIGINT)
        out, err = running.communicate(timeout=20)
    finally:
        running.kill()
        running.wait()
    assert (running.returncode, out, err) == (0, "", "ended\n")


def test_connections_that_send_nothing_are_closed(drawn, monkeypatch):
    monkeypatch.setattr(Handler, "timeout", 0.2)
    before = threading.active_count()
    with drawn.serve(0) as served:
        silent = [socket.create_connection(("127.0.0.1", served.port), timeout=10.0) for _ in range(10)]
        for connection in silent:
            with suppress(ConnectionResetError):
                assert connection.recv(1) == b""  # closed
            connection.close()
        assert get(served.port).status == 200
    until = time.monotonic() + 5.0  # threads end a moment after their connections
    while threading.active_count() > before and time.monotonic() < until:
        time.sleep(0.01)
    assert threading.active_count() <= before
