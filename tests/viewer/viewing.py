# SPDX-License-Identifier: Apache-2.0
"""A running `engram view`, and the commands that its answers are compared with."""

from __future__ import annotations

import http.client
import json
import pathlib
import signal
import subprocess
import urllib.parse
from typing import Any

#: What a browser that is let in sends.
Headers = dict[str, str]


class Viewed:
    """`engram view` of a store or a server. Threading: one thread."""

    def __init__(self, engram: str, *arguments: str) -> None:
        self.engram = engram
        self.process = subprocess.Popen([engram, "view", *arguments, "--json"], text=True,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        assert self.process.stdout
        line = self.process.stdout.readline()
        if not line:
            assert self.process.stderr
            raise AssertionError(self.process.stderr.read())
        self.url = json.loads(line)["url"]
        parts = urllib.parse.urlsplit(self.url)
        assert parts.hostname and parts.port
        self.host, self.port = parts.hostname, parts.port
        self.token = urllib.parse.parse_qs(parts.query)["token"][0]
        self.cookie = f"engram_viewer_{self.port}={self.token}"

    def __enter__(self) -> Viewed:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.send_signal(signal.SIGINT)
        self.process.wait(20)
        assert self.process.stdout and self.process.stderr
        self.process.stdout.close()
        self.process.stderr.close()

    def ask(self, target: str, method: str = "GET",
            headers: Headers | None = None) -> tuple[int, Headers, bytes]:
        """Sends a request as the page does; `headers` replace those with equal names."""
        connection = http.client.HTTPConnection(self.host, self.port, timeout=60)
        try:
            connection.request(method, target, headers={"Cookie": self.cookie, **(headers or {})})
            response = connection.getresponse()
            body = response.read()
            return response.status, {k.lower(): v for k, v in response.getheaders()}, body
        finally:
            connection.close()

    def get(self, where: str, /, **parameters: Any) -> tuple[int, Headers, bytes]:
        return self.ask(where + ("?" + urllib.parse.urlencode(parameters, doseq=True)
                                if parameters else ""))

    def json(self, where: str, /, **parameters: Any) -> Any:
        status, _, body = self.get(where, **parameters)
        if status != 200:
            raise AssertionError(f"{where}: {status} {body[:500]!r}")
        return json.loads(body)

    def error(self, where: str, /, **parameters: Any) -> tuple[int, str]:
        """The HTTP status and the code of an error."""
        status, _, body = self.get(where, **parameters)
        return status, json.loads(body)["error"]["code"]


def resident_mb(process: int) -> float:
    """What a process has in memory."""
    status = pathlib.Path(f"/proc/{process}/status").read_text()
    return int(status.split("VmRSS:")[1].split()[0]) / 1024


def run(engram: str, *arguments: str) -> str:
    return subprocess.run([engram, *arguments], check=True, capture_output=True, text=True).stdout


def make_kitchen(engram: str, folder: pathlib.Path, seconds: int, learned: bool) -> pathlib.Path:
    store = folder / "kitchen.engram"
    run(engram, "simulate", "kitchen", str(store), "--fast", "--depth", "--seconds", str(seconds))
    if learned:
        run(engram, "consolidate", str(store), "--entity", "Vision/RGB/head/stereo", "--steps", "2",
            "--psnr", "26", "--video", "h264")
    return store
