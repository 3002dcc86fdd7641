# SPDX-License-Identifier: Apache-2.0
"""Who means harm is refused, and the viewer goes on: hostile_test.py ENGRAM."""

from __future__ import annotations

import contextlib
import json
import pathlib
import resource
import select
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import unittest
from typing import Any

from viewing import Viewed, make_kitchen, run

ENGRAM = sys.argv.pop()
JOINTS = "RobotState/Proprioception/robot/joints"
STEREO = "Vision/RGB/head/stereo"


class HostileTest(unittest.TestCase):
    folder: tempfile.TemporaryDirectory[str]
    viewed: Viewed

    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        cls.store = make_kitchen(ENGRAM, pathlib.Path(cls.folder.name), 3, False)
        cls.viewed = Viewed(ENGRAM, str(cls.store))

    @classmethod
    def tearDownClass(cls) -> None:
        cls.viewed.__exit__()
        cls.folder.cleanup()

    def tearDown(self) -> None:
        self.assertIsNone(self.viewed.process.poll())
        self.viewed.json("/api/info")

    def connect(self) -> socket.socket:
        return socket.create_connection((self.viewed.host, self.viewed.port), timeout=30)

    def send(self, data: bytes) -> bytes:
        """Everything that comes back until the connection ends."""
        with self.connect() as connection:
            # What is refused early may be reset while it is still sent.
            with contextlib.suppress(ConnectionError):
                connection.sendall(data)
            received = b""
            with contextlib.suppress(ConnectionError):
                while part := connection.recv(1 << 16):
                    received += part
            return received

    def status_of(self, data: bytes) -> int:
        received = self.send(data)
        return int(received.split(b" ", 2)[1]) if received.startswith(b"HTTP/1.1 ") else 0

    def head(self, target: str = "/api/info", more: str = "", host: str | None = None) -> bytes:
        return (f"GET {target} HTTP/1.1\r\nHost: {host or f'127.0.0.1:{self.viewed.port}'}\r\n"
                f"Cookie: {self.viewed.cookie}\r\nConnection: close\r\n{more}\r\n").encode()

    def test_a_request_that_is_right_passes(self) -> None:
        self.assertEqual(self.status_of(self.head()), 200)

    def test_without_the_token_nothing_is_shown(self) -> None:
        for cookie in ("", f"engram_viewer_{self.viewed.port}=x", "a=b"):
            status, headers, body = self.viewed.ask("/api/info", headers={"Cookie": cookie})
            self.assertEqual(status, 401)
            self.assertNotIn(b"kitchen", body)
            self.assertEqual(self.viewed.ask("/", headers={"Cookie": cookie})[0], 403)
        self.assertEqual(self.viewed.ask("/?token=wrong", headers={"Cookie": ""})[0], 403)
        self.assertEqual(self.viewed.ask(f"/api/info?token={self.viewed.token}",
                                         headers={"Cookie": ""})[0], 401)

    def test_the_token_becomes_a_cookie(self) -> None:
        status, headers, _ = self.viewed.ask(f"/?token={self.viewed.token}&view=1",
                                             headers={"Cookie": ""})
        self.assertEqual((status, headers["location"]), (303, "/?view=1"))
        self.assertEqual(headers["set-cookie"],
                         f"{self.viewed.cookie}; HttpOnly; SameSite=Strict; Path=/")

    def test_another_host_is_refused(self) -> None:
        for host in ("evil.example", f"evil.example:{self.viewed.port}", "127.0.0.1", "localhost"):
            self.assertEqual(self.status_of(self.head(host=host)), 421, host)
        self.assertEqual(self.status_of(b"GET / HTTP/1.1\r\n\r\n"), 400)
        self.assertEqual(self.status_of(b"GET / HTTP/1.0\r\n\r\n"), 400)
        self.assertEqual(self.status_of(self.head(more="Host: evil.example\r\n")), 400)

    def test_pages_of_others_get_nothing(self) -> None:
        for site in ("cross-site", "same-site"):
            status, headers, _ = self.viewed.ask(
                "/api/info", headers={"Sec-Fetch-Site": site, "Origin": "http://evil.example"})
            self.assertEqual(status, 403)
            self.assertNotIn("access-control-allow-origin", headers)

    def test_every_answer_has_the_headers_that_bind_browsers(self) -> None:
        for target, cookie in (("/", self.viewed.cookie), ("/", ""), ("/api/info", ""),
                               ("/api/none", self.viewed.cookie), ("/%", self.viewed.cookie)):
            _, headers, _ = self.viewed.ask(target, headers={"Cookie": cookie})
            self.assertIn("default-src 'none'", headers["content-security-policy"])
            self.assertIn("frame-ancestors 'none'", headers["content-security-policy"])
            self.assertEqual(headers["x-content-type-options"], "nosniff")
            self.assertEqual(headers["referrer-policy"], "no-referrer")

    def test_no_path_leads_out(self) -> None:
        for path in ("/../../etc/passwd", "/assets/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd",
                     "/assets/%2e%2e%2findex.html", "//etc/passwd", "/api/../etc/passwd", "/api",
                     "/api/", "/API/info", "/api/info/", "/assets/", "/.git/config"):
            self.assertEqual(self.status_of(self.head(path)), 404, path)
        for target in ("http://evil.example/", "*", "evil.example:443", "/%00", "/%ff", "/%",
                       "/?a=%zz"):
            self.assertEqual(self.status_of(self.head(target)), 400, target)

    def test_only_looking_is_let(self) -> None:
        for method in ("POST", "PUT", "DELETE", "OPTIONS", "PATCH", "BREW"):
            status, headers, _ = self.viewed.ask("/api/info", method)
            self.assertEqual((status, headers["allow"]), (405, "GET, HEAD"), method)
        self.assertEqual(self.status_of(self.head(more="Content-Length: 5\r\n") + b"hello"), 413)
        self.assertEqual(self.status_of(self.head(more="Content-Length: 99999999999999\r\n")), 413)
        self.assertIn(self.status_of(self.head(more="Transfer-Encoding: chunked\r\n")
                                     + b"5\r\nhello\r\n0\r\n\r\n"), (400, 413))

    def test_what_is_no_http_is_refused(self) -> None:
        for data in (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", b"SSH-2.0-evil\r\n\r\n",
                     b"GET\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n", b"\0" * 100, b"\r\n" * 100,
                     self.head(more="A B: c\r\n"), self.head(more=": c\r\n"),
                     self.head(more="Content-Length: 1\r\nContent-Length: 2\r\n"),
                     self.head(more="Content-Length: -1\r\n")):
            with self.connect() as connection:
                connection.sendall(data)
                connection.shutdown(socket.SHUT_WR)
                received = connection.recv(1 << 16)
            self.assertTrue(received == b"" or received.split(b" ")[1] in (b"400", b"413"), data)

    def test_endless_headers_are_cut(self) -> None:
        self.assertEqual(self.status_of(self.head(more="X: " + "a" * 200_000 + "\r\n")), 431)
        self.assertEqual(self.status_of(self.head(more="A: b\r\n" * 50_000)), 431)
        self.assertEqual(self.status_of(self.head("/?" + "a" * 200_000)), 431)
        with self.connect() as connection:
            sent = 0
            with contextlib.suppress(ConnectionError):
                while sent < 50 << 20:
                    connection.sendall(b"A: " + b"b" * 10_000 + b"\r\n")
                    sent += 10_000
            self.assertLess(sent, 20 << 20)

    def test_numbers_that_are_none_are_refused(self) -> None:
        good: dict[str, Any] = {"entity": JOINTS, "from": "0", "to": "10", "pixels": "5"}
        self.assertEqual(self.viewed.get("/api/density", **good)[0], 200)
        for name in ("from", "to", "pixels"):
            for value in ("", "nan", "inf", "-inf", "1e9", "0x5", "9" * 30, "-" + "9" * 30, "1.5",
                          " 1", "\u0661"):
                self.assertEqual(self.viewed.error("/api/density", **{**good, name: value}),
                                 (400, "invalid argument"), (name, value))
        for wrong in ({"from": 10, "to": 10}, {"from": 11, "to": 10}, {"pixels": 0},
                      {"pixels": -1}, {"pixels": 65537}):
            self.assertEqual(self.viewed.error("/api/density", **{**good, **wrong}),
                             (400, "invalid argument"), wrong)
        # All times that there are.
        status, _, body = self.viewed.get("/api/density", **{
            **good, "from": -(1 << 63), "to": (1 << 63) - 1, "pixels": 65536})
        self.assertEqual((status, len(body)), (200, 3 * 4 * 65536))
        self.assertEqual(self.viewed.error("/api/density", **{**good, "entity": [JOINTS] * 100,
                                                              "pixels": 65536}),
                         (413, "resource exhausted"))
        self.assertEqual(self.viewed.error("/api/density", **{**good, "entity": [JOINTS] * 257}),
                         (400, "invalid argument"))
        self.assertEqual(self.viewed.error("/api/moment", entity=JOINTS, at=1 << 63),
                         (400, "invalid argument"))
        for at in (-(1 << 63), (1 << 63) - 1):
            for which in ("at-or-before", "nearest", "exact", "predict"):
                self.assertIn(self.viewed.get("/api/moment", entity=JOINTS, at=at,
                                              which=which)[0], (200, 400, 404), (at, which))
        self.assertEqual(self.viewed.error("/api/predict", entity=JOINTS,
                                           horizon=(1 << 63) - 1)[0], 400)
        self.assertEqual(self.viewed.error("/api/image", id=f"{JOINTS}/{'9' * 25}", path="a")[0], 400)

    def test_names_that_are_none_are_refused(self) -> None:
        for name in ("", "a", "a/b/c", "a//c/d", "/", "a/b/c/d/not a time", "\\", "a/b/c/d\\",
                     "a/" * 10_000):
            self.assertIn(self.viewed.error("/api/members", entity=name)[0], (400, 404), name[:20])
        for path in ("[", "]", "[]", "[[[[", "positions[9999999]", "a" * 50_000, "/" * 10_000):
            status, _, body = self.viewed.get("/api/series", entity=JOINTS, path=path,
                                              **{"from": 0}, to=2 * 10**18, pixels=2)
            self.assertEqual((status, len(body)), (200, 24), path[:20])
        self.assertEqual(self.viewed.error("/api/series", entity=JOINTS, path=["a"] * 65,
                                           **{"from": 0}, to=9, pixels=2), (400, "invalid argument"))
        for query in ("(" * 10_000, "a" * 60_000, "((((((((((a*)*)*)*)*)*)*)*)*)*)*",
                      "@ all near 1,2", "?ids?ids"):
            self.assertIn(self.viewed.get("/api/query", q=query)[0], (400, 404), query[:20])

    def test_ten_thousand_connections_come_and_go(self) -> None:
        before = self.resident()
        for _ in range(10_000):
            self.connect().close()
        self.assertLess(self.resident() - before, 50 << 20)

    def test_hundreds_of_connections_at_once_are_bounded(self) -> None:
        limits = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(4096, limits[1]), limits[1]))
        with contextlib.ExitStack() as stack:
            held = [stack.enter_context(self.connect()) for _ in range(600)]
            # Those that are too many are closed at once, before the first request is late.
            poll = select.poll()
            for connection in held:
                poll.register(connection, select.POLLIN)
            end = time.monotonic() + 8
            while (closed := len(poll.poll(100))) < 600 - 256 and time.monotonic() < end:
                time.sleep(0.1)
            self.assertGreaterEqual(closed, 600 - 256)
            self.assertLess(closed, 600)
            descriptors = len(list(pathlib.Path(f"/proc/{self.program()}/fd").iterdir()))
            self.assertLess(descriptors, 256 + 100)
        self.viewed.json("/api/info")

    def test_half_open_connections_end(self) -> None:
        with contextlib.ExitStack() as stack:
            silent = stack.enter_context(self.connect())
            slow = stack.enter_context(self.connect())
            slow.sendall(b"GET /api/info HTTP/1.1\r\n")
            begin = time.monotonic()
            with contextlib.suppress(ConnectionError):
                while time.monotonic() - begin < 25:
                    slow.sendall(b"A: b\r\n")  # A byte now and then does not keep it open.
                    time.sleep(0.5)
            self.assertLess(time.monotonic() - begin, 20)
            with contextlib.suppress(ConnectionError):
                self.assertEqual(silent.recv(1), b"")

    def test_many_requests_at_once_are_answered(self) -> None:
        with contextlib.ExitStack() as stack:
            held = [stack.enter_context(self.connect()) for _ in range(200)]
            for connection in held:
                connection.sendall(self.head())
            statuses = [connection.recv(1 << 16).split(b" ")[1] for connection in held]
        self.assertEqual(set(statuses) | {b"503"}, {b"200", b"503"})
        self.assertGreater(statuses.count(b"200"), 100)

    def test_pipelined_requests_are_answered_in_turn(self) -> None:
        keep = self.head().replace(b"Connection: close\r\n", b"")
        received = self.send(keep + keep + self.head())
        self.assertEqual(received.count(b"HTTP/1.1 200"), 3)

    def program(self) -> int:
        """The launcher becomes the program, so both have one number."""
        return self.viewed.process.pid

    def resident(self) -> int:
        for line in pathlib.Path(f"/proc/{self.program()}/status").read_text().split("\n"):
            if line.startswith("VmRSS:"):
                return int(line.split()[1]) << 10
        raise AssertionError("no VmRSS")


class ListenTest(unittest.TestCase):
    def refused(self, *arguments: str) -> tuple[int, str]:
        with tempfile.TemporaryDirectory() as folder:
            store = pathlib.Path(folder) / "a.engram"
            run(ENGRAM, "simulate", "kitchen", str(store), "--fast", "--seconds", "1")
            done = subprocess.run([ENGRAM, "view", str(store), *arguments], capture_output=True,
                                  text=True, timeout=60, check=False)
            return done.returncode, done.stderr

    def test_the_network_is_refused(self) -> None:
        for listen in ("0.0.0.0:0", "[::]:0", "10.0.0.1:0", "example.org:80"):
            code, message = self.refused("--listen", listen)
            self.assertEqual(code, 1, listen)
            self.assertIn("neither TLS nor grants", message)

    def test_what_is_no_endpoint_is_wrong_usage(self) -> None:
        for listen in ("unix:/tmp/a.sock", "127.0.0.1", "127.0.0.1:99999", ""):
            self.assertEqual(self.refused("--listen", listen)[0], 2, listen)
        self.assertEqual(self.refused("--embed", "http://a; script-src *")[0], 2)


class ChangingStoreTest(unittest.TestCase):
    """The store changes while it is looked at."""

    def setUp(self) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.store = make_kitchen(ENGRAM, pathlib.Path(self.folder.name), 3, False)
        self.viewed = Viewed(ENGRAM, str(self.store))
        self.addCleanup(self.viewed.__exit__)
        self.first = int(self.viewed.json("/api/info")["first"])
        self.last = int(self.viewed.json("/api/info")["last"])

    def look(self) -> list[int]:
        """The HTTP statuses of a look around."""
        span = {"from": self.first, "to": self.last + 1, "pixels": 50}
        moment = self.viewed.get("/api/moment", entity=STEREO, at=self.last)
        statuses = [moment[0]]
        for path, parameters in (
                ("/api/info", {}), ("/api/tree", {"under": "Vision/RGB/head"}),
                ("/api/density", {"entity": [STEREO, JOINTS], **span}),
                ("/api/series", {"entity": JOINTS, "path": "positions[0]", **span}),
                ("/api/members", {"entity": JOINTS}), ("/api/nights", {})):
            statuses.append(self.viewed.get(path, **parameters)[0])
        if moment[0] == 200:
            id_ = json.loads(moment[2])["id"]
            statuses.append(self.viewed.get("/api/image", id=id_, path="image")[0])
        return statuses

    def test_a_night_is_seen(self) -> None:
        self.assertEqual(set(self.look()), {200})
        night = subprocess.Popen(
            [ENGRAM, "consolidate", str(self.store), "--entity", STEREO, "--steps", "2", "--psnr",
             "26", "--video", "h264"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while night.poll() is None:
            self.assertEqual(set(self.look()), {200})
        self.assertEqual(night.returncode, 0)
        time.sleep(0.3)
        self.assertEqual(set(self.look()), {200})
        told = self.viewed.json("/api/tree", under="Vision/RGB/head")["children"]
        stereo = next(one for one in told if one["id"] == STEREO)
        info = json.loads(run(ENGRAM, "info", str(self.store), "--json"))
        known = next(one for one in info["entities"] if one["id"] == STEREO)
        self.assertGreater(known["latent_snapshots"], 0)
        self.assertEqual(stereo["forms"]["latent"], known["latent_snapshots"])
        self.assertEqual(stereo["models"], len(known["models"]))
        moment = self.viewed.json("/api/moment", entity=STEREO, at=self.last)
        for form, source in (("latent", "reconstructed"), ("recorded", "recorded"),
                             ("error", "reconstructed")):
            status, headers, body = self.viewed.get("/api/image", id=moment["id"], path="image",
                                                    form=form)
            self.assertEqual((status, headers["x-engram-source"]), (200, source), form)
            if form == "error":
                self.assertGreater(float(headers["x-engram-psnr"]), 20)
                self.assertGreaterEqual(float(headers["x-engram-gain"]), 1)
        quality = self.viewed.json("/api/quality", entity=STEREO, sample=8, budget=60000)
        self.assertEqual((quality["compared"], quality["unknown"]), (quality["asked"], 0))
        self.assertEqual(sum(quality["counts"]), quality["compared"])
        self.assertGreater(quality["compared"], 4)
        worst = [one["psnr"] for one in quality["worst"]]
        self.assertEqual(worst, sorted(worst))
        self.assertTrue(quality["low"] <= worst[0] < quality["low"] + quality["step"])
        # It is the figure that is told with the image itself.
        _, headers, _ = self.viewed.get("/api/image", id=quality["worst"][0]["id"], path="image",
                                        form="error")
        self.assertAlmostEqual(float(headers["x-engram-psnr"]), worst[0], delta=1.5)

    def test_what_is_forgotten_is_gone(self) -> None:
        self.assertEqual(set(self.look()), {200})
        run(ENGRAM, "forget", str(self.store), f"{STEREO} @ all", "--yes")
        time.sleep(0.3)
        self.assertEqual(self.viewed.error("/api/moment", entity=STEREO, at=self.last)[0], 404)
        self.assertNotIn(STEREO, self.viewed.json("/api/find", text="stereo")["found"])

    def test_a_damaged_store_is_an_error_and_no_end(self) -> None:
        for segment in (self.store / "segments").glob("*.h5"):
            data = bytearray(segment.read_bytes())
            for place in range(2048, len(data), 997):
                data[place] ^= 0x5a
            segment.write_bytes(data)
        statuses = self.look()
        self.assertTrue(set(statuses) <= {200, 404, 500}, statuses)
        self.assertIn(500, statuses)
        shutil.rmtree(self.store)
        self.assertTrue(set(self.look()) <= {200, 404, 500, 503}, statuses)
        self.assertIsNone(self.viewed.process.poll())


if __name__ == "__main__":
    unittest.main()
