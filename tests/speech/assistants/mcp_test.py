#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`engram mcp`, used by the official SDK of the Model Context Protocol, and by strangers.

mcp_test.py ENGRAM WORK: packages of npm are installed in WORK. Exit code 77 says that npm could not
fetch them.
"""

from __future__ import annotations

import base64
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
from typing import Any

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "viewer"))
import build_page  # noqa: E402

ENGRAM = str(pathlib.Path(sys.argv[1]).resolve())
WORK = pathlib.Path(sys.argv[2]).resolve()
NOT_RUN = 77


def make_store(folder: pathlib.Path) -> pathlib.Path:
    store = folder / "kitchen.engram"
    subprocess.run([ENGRAM, "-q", "simulate", "kitchen", str(store), "--fast",
                    "--seconds", "5"], check=True)
    return store


def query(store: pathlib.Path, text: str) -> list[dict[str, Any]]:
    done = subprocess.run([ENGRAM, "query", str(store), text, "--json", "--unnoted"], check=True,
                          capture_output=True, text=True)
    return json.loads(done.stdout)["entities"]


def talk(store: pathlib.Path, *lines: bytes) -> list[dict[str, Any]]:
    """What the command answers to lines of stdin, until it ends with stdin."""
    done = subprocess.run([ENGRAM, "mcp", str(store)], input=b"\n".join(lines) + b"\n", check=True,
                          capture_output=True, timeout=60)
    return [json.loads(line) for line in done.stdout.splitlines()]


def entities(store: pathlib.Path, names: str) -> set[str]:
    """The entities, of which each of the kitchen's has four plain names."""
    done = subprocess.run([ENGRAM, "query", str(store), f"?ids {names} @ latest", "--json",
                           "--unnoted"], check=True, capture_output=True, text=True)
    return {"/".join(one.split("/")[:4]) for one in json.loads(done.stdout)["ids"]}


START = (b'{"jsonrpc":"2.0","id":1,"method":"initialize","params":{"protocolVersion":"2025-06-18",'
         b'"capabilities":{},"clientInfo":{"name":"test","version":"1"}}}')


class Mcp(unittest.TestCase):
    """One store for all tests."""

    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        cls.store = make_store(pathlib.Path(cls.folder.name))

    @classmethod
    def tearDownClass(cls) -> None:
        cls.folder.cleanup()

    def test_the_official_client_uses_every_tool(self) -> None:
        # A moment at which objects were seen, in the midst of the recording.
        middle = query(self.store, "Objects/Instances @ nearest:2026-01-01 08:00:02")[0]
        middle = middle["snapshots"][0]["id"].rsplit("/", 1)[1]
        done = subprocess.run(["node", "client.mjs", ENGRAM, str(self.store), middle], cwd=WORK,
                              check=True, capture_output=True, text=True, timeout=300)
        told = json.loads(done.stdout)
        self.assertEqual(told["server"]["name"], "engram")
        self.assertIn("does not know", told["instructions"])
        self.assertEqual([one["name"] for one in told["tools"]],
                         ["ask", "timeline", "entities", "query", "near", "similar", "why",
                          "picture"])
        spoken = query(self.store, "Speech @ 0..0")[0]["snapshots"][0]
        said = spoken["instances"][0]["data"]["text"]
        asked = told["ask"]["structuredContent"]
        self.assertIn(said, asked["text"])
        self.assertIn(spoken["id"], [re.sub("/0$", "", one["id"]) for one in asked["evidence"]])
        self.assertEqual(told["unknown"]["structuredContent"]["value"], {"kind": "unknown"})
        done_ = told["timeline"]["structuredContent"]
        started = {one["id"] for entity in query(self.store, "Skill/Event @ all")
                   for one in entity["snapshots"]
                   if one["instances"][0]["data"]["stage"] == {"$int32": 0}}
        self.assertEqual({re.sub("/0$", "", one["id"]) for one in done_["executions"]}, started)
        self.assertTrue(all(one["evidence"] for one in done_["told"]))
        listed = {one["id"] for one in told["entities"]["structuredContent"]["entities"]}
        self.assertEqual(listed, entities(self.store, ""))
        self.assertEqual(len(told["some"]["structuredContent"]["entities"]), 2)
        self.assertTrue(told["some"]["structuredContent"]["has_more"])

        platform = query(self.store, "RobotState/Localization @ latest:2")[0]
        answered = told["query"]["structuredContent"]["entities"][0]
        self.assertEqual([one["id"] for one in answered["snapshots"]],
                         [one["id"] for one in platform["snapshots"]])
        # Older assistants have the same as a text.
        self.assertEqual(json.loads(told["query"]["content"][0]["text"]),
                         told["query"]["structuredContent"])
        self.assertEqual(told["bounded"]["structuredContent"]["snapshots"], 5)
        self.assertTrue(told["bounded"]["structuredContent"]["has_more"])
        image = told["image"]["structuredContent"]["entities"][0]["snapshots"][0]["instances"][0]
        self.assertEqual(image["image"]["$image"]["width"], 128)

        objects = entities(self.store, "Objects/Instances")
        near = told["near"]["structuredContent"]["entities"]
        self.assertEqual({one["id"] for one in near}, objects)
        self.assertTrue(all(one["snapshots"] > 0 and one["first"] <= one["last"] for one in near))
        times = {what: told[what]["structuredContent"]["entities"]
                 for what in ("near", "nearFrom", "nearUntil", "nearBetween")}
        for whole, since, up_to, at in zip(*times.values(), strict=True):
            self.assertEqual((since["first"], since["last"]), (middle, whole["last"]))
            self.assertEqual((up_to["first"], up_to["last"]), (whole["first"], middle))
            self.assertEqual((at["snapshots"], at["first"], at["last"]), (1, middle, middle))
            self.assertEqual(since["snapshots"] + up_to["snapshots"], whole["snapshots"] + 1)
        self.assertEqual(told["nowhere"]["structuredContent"]["entities"], [])
        self.assertEqual(len(told["similar"]["structuredContent"]["moments"]), 3)
        self.assertIn(said, told["why"]["structuredContent"]["text"])
        picture = told["picture"]["content"][1]
        self.assertEqual(picture["mimeType"], "image/jpeg")
        self.assertTrue(base64.b64decode(picture["data"]).startswith(b"\xff\xd8"))

        for what, expected in {"no query": "query", "missing": "'query' is missing",
                               "unknown": "'limit' is unknown", "kind": "finite number", "backwards": "at or after 'from'",
                               "nothing there": "not found", "no picture": "has no image",
                               "instructions": "invalid argument"}.items():
            with self.subTest(what):
                self.assertTrue(told["wrong"][what]["isError"])
                self.assertIn(expected, told["wrong"][what]["content"][0]["text"])
        self.assertIn("there is no tool 'forget'", told["noTool"])

    def test_what_is_no_request_is_answered_and_ends_nothing(self) -> None:
        ping = b'{"jsonrpc":"2.0","id":"p","method":"ping"}'
        replies = talk(self.store, b"GET / HTTP/1.1", b"", b"[]", b"null", b"{" * 5000,
                       b'{"jsonrpc":"2.0","id":9,"method":"tools/list"}', START, b"\xff\xfe",
                       b'{"jsonrpc":"2.0","method":"notifications/initialized"}',
                       b'{"jsonrpc":"2.0","id":{"a":1},"method":"ping"}',
                       b'{"jsonrpc":"2.0","id":2,"method":"memory/erase"}',
                       b'{"jsonrpc":"2.0","id":3,"method":"tools/call","params":[1]}',
                       b"x" * (2 << 20), ping)
        codes = [one.get("error", {}).get("code") for one in replies]
        self.assertEqual(codes, [-32700, -32600, -32600, -32700, -32600, None, -32700, -32600,
                                 -32601, -32602, -32600, None])
        self.assertEqual(replies[-1], {"jsonrpc": "2.0", "id": "p", "result": {}})

    def test_a_store_that_is_not_there_is_said(self) -> None:
        done = subprocess.run([ENGRAM, "mcp", "/nowhere/at.all"], input=b"", capture_output=True,
                              check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn(b"/nowhere/at.all", done.stderr)
        self.assertEqual(done.stdout, b"")


def main() -> int:
    build_page.copy_sources(pathlib.Path(__file__).parent / "sdk", WORK)
    try:
        build_page.install(WORK)
    except build_page.PageError as error:
        print(f"not run: {error}", file=sys.stderr)
        return NOT_RUN
    program = unittest.main(argv=[sys.argv[0], "-v"], exit=False)
    return 0 if program.result.wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
