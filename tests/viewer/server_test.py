# SPDX-License-Identifier: Apache-2.0
"""The viewer of a server, and the WebSocket that tells what comes: server_test.py ENGRAM."""

from __future__ import annotations

import base64
import json
import os
import pathlib
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest
from typing import Any

import numpy as np
from viewing import Viewed, run

ENGRAM = sys.argv.pop()
CUP = "Objects/Things/kitchen/cup"


class LiveSocket:
    """A WebSocket as a browser opens it (RFC 6455), for texts of up to 64 KiB."""

    def __init__(self, viewed: Viewed, origin: str | None = None, cookie: str | None = None,
                 path: str = "/api/live") -> None:
        self.socket = socket.create_connection((viewed.host, viewed.port), timeout=20)
        key = base64.b64encode(os.urandom(16)).decode()
        home = f"{viewed.host}:{viewed.port}"
        self.socket.sendall(
            (f"GET {path} HTTP/1.1\r\nHost: {home}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
             f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n"
             f"Origin: {f'http://{home}' if origin is None else origin}\r\n"
             f"Cookie: {viewed.cookie if cookie is None else cookie}\r\n\r\n").encode())
        head = b""
        while b"\r\n\r\n" not in head:
            part = self.socket.recv(1)
            if not part:
                break
            head += part
        self.status = int(head.split(b" ", 2)[1])

    def __enter__(self) -> LiveSocket:
        return self

    def __exit__(self, *_: object) -> None:
        self.socket.close()

    def exactly(self, count: int) -> bytes:
        data = b""
        while len(data) < count:
            part = self.socket.recv(count - len(data))
            if not part:
                raise EOFError
            data += part
        return data

    def next(self) -> Any:
        """The next text as JSON; pings are passed over."""
        while True:
            first, length = self.exactly(2)
            if length == 126:
                (length,) = struct.unpack(">H", self.exactly(2))
            payload = self.exactly(length)
            if first & 0xF == 1:
                return json.loads(payload)
            if first & 0xF == 8:
                raise EOFError


class ServerTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.endpoint = f"unix:{folder.name}/engram.sock"
        self.server = subprocess.Popen(
            [ENGRAM, "serve", str(pathlib.Path(folder.name) / "live.engram"), "--listen",
             self.endpoint, "--no-system-state", "--json"], stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(self.end_server)
        assert self.server.stdout
        self.server.stdout.readline()
        for height in (0.1, 0.2, 0.3):
            self.commit(height)
        self.viewed = Viewed(ENGRAM, "--server", self.endpoint)
        self.addCleanup(self.viewed.__exit__)

    def end_server(self) -> None:
        if self.server.poll() is None:
            self.server.send_signal(signal.SIGTERM)
            self.server.wait(20)
        assert self.server.stdout
        self.server.stdout.close()

    def commit(self, height: float) -> None:
        run(ENGRAM, "commit", CUP, "--server", self.endpoint, "--data", json.dumps({"height": height}))

    def test_a_server_is_shown(self) -> None:
        info = self.viewed.json("/api/info")
        self.assertEqual((info["entities"], info["snapshots"], info["is_live"]), (1, None, True))
        self.assertEqual(self.viewed.json("/api/tree", under="Objects/Things/kitchen")["children"],
                         [{"name": "cup", "id": CUP, "level": "entity", "entities": 1}])
        self.assertEqual(self.viewed.json("/api/find", text="CUP")["found"], [CUP])
        span = {"from": info["first"], "to": int(info["last"]) + 1, "pixels": 1}
        counts = np.frombuffer(self.viewed.get("/api/density", entity="Objects", **span)[2], "<u4")
        self.assertEqual(counts.tolist(), [3, 0, 0])
        self.assertEqual(self.viewed.json("/api/members", entity=CUP)["members"],
                         [{"path": "height", "kind": "number", "shape": []}])
        drawn = np.frombuffer(self.viewed.get("/api/series", entity=CUP, path="height",
                                              **span)[2], "<f4")
        np.testing.assert_allclose(drawn[2], 0.3, rtol=1e-6)
        moment = self.viewed.json("/api/moment", entity=CUP, at=info["last"])
        self.assertEqual((moment["source"], moment["next"]), ("recorded", None))
        self.assertEqual(int(self.viewed.json("/api/step", entity=CUP, at=info["last"],
                                              by=-2)["time"]), int(info["first"]))
        self.assertEqual(self.viewed.error("/api/nights"), (409, "failed precondition"))
        query = f"{CUP} @ all"
        self.assertEqual(self.viewed.json("/api/query", q=query), json.loads(
            run(ENGRAM, "query", "--server", self.endpoint, query, "--json")))

    def test_what_comes_is_told(self) -> None:
        with LiveSocket(self.viewed) as one, LiveSocket(self.viewed) as other:
            self.assertEqual((one.status, other.status), (101, 101))
            self.commit(0.4)
            last = self.viewed.json("/api/info")["last"]
            for live in (one, other):
                told = live.next()
                self.assertEqual(told["kind"], "commit")
                self.assertEqual(told["ids"],
                                 [self.viewed.json("/api/moment", entity=CUP, at=last)["id"]])

    def test_only_our_page_is_told(self) -> None:
        for options, status in (({"origin": "http://evil.example"}, 403), ({"origin": ""}, 403),
                                ({"origin": "null"}, 403), ({"cookie": ""}, 401),
                                ({"cookie": "engram_viewer=x"}, 401), ({"path": "/api/info"}, 404),
                                ({"path": "/api/%zz"}, 400)):
            with LiveSocket(self.viewed, **options) as live:
                self.assertEqual(live.status, status, options)

    def test_sockets_are_bounded_and_given_back(self) -> None:
        for _ in range(2):
            held = [LiveSocket(self.viewed) for _ in range(32)]
            self.assertEqual({live.status for live in held}, {101})
            with LiveSocket(self.viewed) as one_more:
                self.assertEqual(one_more.status, 503)
            for live in held:
                live.socket.close()
            time.sleep(1)  # The gateway notices what is closed when it reads.

    def test_a_server_that_ends_is_an_error_and_no_end(self) -> None:
        self.end_server()
        status, code = self.viewed.error("/api/find", text="cup")
        self.assertEqual((status, code), (503, "unavailable"))
        self.assertIsNone(self.viewed.process.poll())


if __name__ == "__main__":
    unittest.main()
