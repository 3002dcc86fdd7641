# SPDX-License-Identifier: Apache-2.0
"""Nights, reflections, and what forgetting would do, against the commands: nights_test.py ENGRAM."""

from __future__ import annotations

import hashlib
import json
import pathlib
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


def digest(store: pathlib.Path) -> dict[str, str]:
    """What every file of a store holds; locks are empty and may come."""
    return {str(file.relative_to(store)): hashlib.sha256(file.read_bytes()).hexdigest()
            for file in sorted(store.rglob("*")) if file.is_file() and file.suffix != ".lock"}


class NightsTest(unittest.TestCase):
    folder: tempfile.TemporaryDirectory[str]
    viewed: Viewed

    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        cls.began = time.time_ns()
        cls.store = make_kitchen(ENGRAM, pathlib.Path(cls.folder.name), 6, True)
        cls.consolidated = time.time_ns()
        cls.before = run(ENGRAM, "forget", str(cls.store), "--json", "--yes",
                         "Objects/Instances/.* @ 0..2")
        run(ENGRAM, "reflect", str(cls.store), "--commit", "--findings", "0")
        cls.viewed = Viewed(ENGRAM, str(cls.store))
        cls.info = {one["id"]: one
                    for one in json.loads(run(ENGRAM, "info", str(cls.store), "--json"))["entities"]}

    @classmethod
    def tearDownClass(cls) -> None:
        cls.viewed.__exit__()
        cls.folder.cleanup()

    def dry_run(self, config: str) -> Any:
        file = pathlib.Path(self.folder.name) / "policy.yaml"
        file.write_text(config)
        return json.loads(run(ENGRAM, "forget", str(self.store), "--config", str(file), "--dry-run",
                              "--json"))["plan"]

    def compare(self, told: Any, plan: Any) -> None:
        """A plan of the page with that of the command."""
        entities = {one["id"]: one for one in plan.pop("entities")}
        # What is free on the disk changes meanwhile.
        told["plan"].pop("free_disk_bytes")
        plan.pop("free_disk_bytes")
        self.assertEqual(told["plan"], plan)
        self.assertEqual({one["id"] for one in told["entities"]}, set(entities))
        self.assertEqual(told["left_out"], 0)
        begin, length = int(told["from"]), int(told["to"]) - int(told["from"])
        for one in told["entities"]:
            known = entities[one["id"]]
            lane = one.pop("lane")
            times = known.pop("times_ns")
            fading = [(part.get("psnr"), part.pop("times_ns")) for part in known["fading"]]
            self.assertEqual([(part.get("psnr"), part["snapshots"]) for part in one["fading"]],
                             [(psnr, len(part)) for psnr, part in fading])
            self.assertEqual(one, known)
            for name, needed in (("gone", times), ("fades", sum((part for _, part in fading), []))):
                counts = [0] * told["bins"]
                for moment in needed:
                    counts[(moment - begin) * told["bins"] // length] += 1
                self.assertEqual(lane[name], counts, (one["id"], name))
            self.assertEqual(sum(lane["stays"]), one["stays"] - sum(lane["fades"]))

    def test_a_night_is_told_as_it_was(self) -> None:
        told = self.viewed.json("/api/nights")
        self.assertEqual((len(told["nights"]), told["unreadable"], told["more"]), (2, 0, False))
        forgot, learned = told["nights"]
        self.assertEqual((learned["work"], learned["failure"]), ("consolidate", ""))
        self.assertTrue(self.began < int(learned["began"]) < int(learned["ended"])
                        < self.consolidated)
        (stereo,) = learned["entities"]
        known = self.info[STEREO]
        self.assertEqual((stereo["id"], stereo["encoded"]), (STEREO, known["latent_snapshots"]))
        self.assertEqual(stereo["bytes_after"] - stereo["bytes_before"],
                         known["latent_bytes"] + known["model_bytes"])
        self.assertEqual(stereo["models_added"], [1])
        self.assertGreaterEqual(stereo["min_psnr"], 26)
        done = json.loads(self.before)
        self.assertEqual(forgot["work"], "forget")
        self.assertEqual({one["id"]: one["forgotten"] for one in forgot["entities"]},
                         {one["id"]: one["forgotten"] for one in done["plan"]["entities"]
                          if one["forgotten"] > 0})
        self.assertEqual(sum(one["forgotten"] for one in forgot["entities"]),
                         done["done"]["snapshots"])
        self.assertGreater(learned["bytes_after"], forgot["bytes_after"])
        self.assertEqual(len(self.viewed.json("/api/nights", max=1)["nights"]), 1)

    def test_a_record_that_is_damaged_is_counted(self) -> None:
        broken = self.store / "nights" / "9.json"
        broken.write_text('{"work": "consolidate", "entities": [')
        self.addCleanup(broken.unlink)
        told = self.viewed.json("/api/nights")
        self.assertEqual((len(told["nights"]), told["unreadable"]), (2, 1))

    def test_a_plan_is_the_dry_run_of_the_command(self) -> None:
        size = sum(file.stat().st_size for file in self.store.rglob("*") if file.is_file())
        before = digest(self.store)
        for policy in ({"match": "RobotState", "older_than": "0s", "newest": 3},
                       {"older_than": "0s", "newest": 0},
                       {"match": "Vision/RGB", "fade_after": "0s", "fade_psnr": 18},
                       {"match": "Vision/RGB", "fade_after": "0s"},
                       {"keep": "0.25"}, {"unread_for": "0s", "match": "Speech|Skill"},
                       {"max_bytes": f"{size // 2}B"},
                       {"max_bytes": f"{size * 3 // 4}B", "match": "Vision/Depth"},
                       {"max_bytes": "1B", "fade_after": "9d", "fade_psnr": "18"}):
            told = self.viewed.json("/api/forgetting", **policy, bins=17)
            self.compare(told, self.dry_run(told["config"]))
        config = ("forget:\n  rules:\n    - {match: 'RobotState', older_than: 0s, redundant: "
                  "{max_gap: 1s}}\n  protect: {linked: true, entities: [Tasks]}\n")
        told = self.viewed.json("/api/forgetting", config=config)
        self.assertEqual(told["config"], config)
        self.assertGreater(told["plan"]["snapshots"], 0)
        self.compare(told, self.dry_run(config))
        self.assertEqual(digest(self.store), before)

    def test_a_plan_by_age_lies_between_two_of_the_command(self) -> None:
        known = self.info[JOINTS]
        age = time.time_ns() - (known["first_ns"] + known["last_ns"]) // 2
        policy = {"match": "RobotState", "older_than": f"{age}ns"}
        config = f"forget: {{rules: [{{match: RobotState, older_than: {age}ns}}]}}"
        counts = [self.dry_run(config)["snapshots"],
                  self.viewed.json("/api/forgetting", **policy)["plan"]["snapshots"],
                  self.dry_run(config)["snapshots"]]
        self.assertEqual(counts, sorted(counts))
        self.assertGreater(counts[0], 0)

    def test_only_some_lanes_are_drawn(self) -> None:
        told = self.viewed.json("/api/forgetting", older_than="0s", match="RobotState", lanes=1)
        self.assertEqual([("lane" in one) for one in told["entities"]], [True, False])
        self.assertEqual(told["left_out"] + len(told["entities"]), len(self.info))
        whole = self.viewed.json("/api/forgetting", older_than="0s", match="RobotState", lanes=400)
        self.assertEqual(sum(one["stays"] for one in whole["entities"]),
                         sum(one["stays"] for one in told["entities"]) + told["left_out_stays"])

    def test_what_is_no_policy_is_refused_by_name(self) -> None:
        for name, wrong in (("older_than", "soon"), ("older_than", "-3d"), ("older_than", "7"),
                            ("unread_for", "0x"), ("keep", "2"), ("keep", "nan"),
                            ("keep", "0.5}], rules: [{"), ("fade_after", "old"),
                            ("max_bytes", "many"), ("max_bytes", "-1GB"), ("newest", "-1"),
                            ("newest", "1.5"), ("match", "("), ("match", "a\nb"),
                            ("match", "A/B/C/D/E"), ("fade_psnr", "32"), ("bins", "0"),
                            ("lanes", "x"), ("budget", "0"), ("page", "x" * 65)):
            with self.subTest(name=name, wrong=wrong):
                policy = {"older_than": "9d"} if name in ("bins", "lanes", "budget", "page") else {}
                status, _, body = self.viewed.get("/api/forgetting", **policy, **{name: wrong})
                error = json.loads(body)["error"]
                self.assertEqual((status, error["code"]), (400, "invalid argument"))
                self.assertIn(f"parameter '{name}'", error["message"])
        for policy, needed in (({"fade_after": "1d", "fade_psnr": "99"}, "parameter 'fade_psnr'"),
                               ({"config": "forget: {}", "keep": "1"}, "parameter 'keep'"),
                               ({}, "nothing says what is to go"),
                               ({"match": "Vision"}, "nothing says what is to go"),
                               ({"config": "forget: {rules: [{older: 3d}]}"}, "policy:1: "),
                               ({"config": "forget:\n  quota: {max_bytes: 3}"}, "policy:2: "),
                               ({"config": "x: 1"}, "policy:1: "), ({"config": "{"}, "policy:")):
            status, _, body = self.viewed.get("/api/forgetting", **policy)
            self.assertEqual(status, 400, policy)
            self.assertIn(needed, json.loads(body)["error"]["message"])

    def test_a_name_with_quotes_stays_a_name(self) -> None:
        told = self.viewed.json("/api/forgetting", match="it's/#1: {x}", older_than="1d")
        self.assertIn("match: 'it''s/#1: {x}'", told["config"])
        self.assertEqual(told["plan"]["snapshots"], 0)
        self.compare(told, self.dry_run(told["config"]))

    def test_a_plan_ends_when_its_time_is_over(self) -> None:
        config = "forget: {rules: [{redundant: {max_gap: never}}], protect: {linked: true}}"
        status, _, body = self.viewed.get("/api/forgetting", config=config, budget=1)
        self.assertEqual(status, 413)
        self.assertIn("takes longer than 1ms", json.loads(body)["error"]["message"])
        self.assertEqual(self.viewed.json("/api/forgetting", page="a", stop=1), {"called_off": True})

    def test_a_reflection_is_what_the_command_says(self) -> None:
        reflected = json.loads(run(ENGRAM, "reflect", str(self.store), "--json"))
        for told in (self.viewed.json("/api/reflection"),
                     self.viewed.json("/api/reflection", look=1)):
            self.assertEqual(
                [(one["kind"], one["severity"], one["entity"], one["member"], one["count"],
                  one["found"], one["expected"]) for one in told["findings"]],
                [(one["kind"], one["severity"], one["entity"], one["member"], one["count"],
                  one["found"], one["expected"]) for one in reflected["findings"]])
            for one, known in zip(told["findings"], reflected["findings"], strict=True):
                moment = self.viewed.json("/api/moment", entity=known["entity"],
                                          at=known["first_ns"], which="nearest")
                self.assertEqual(int(moment["time"]), known["first_ns"])
                self.assertEqual(one["first_snapshot"], moment["id"])
            self.assertEqual([(one["skill"], one["by"], one["name"], one["runs"])
                              for one in told["rates"]],
                             [(skill["skill"], one["by"], one["name"], one["runs"])
                              for skill in reflected["skills"] for one in skill["rates"]])
            self.assertEqual(told["chains"], reflected["chains"])
        recorded = self.viewed.json("/api/reflection")
        self.assertEqual((recorded["is_recorded"], recorded["times"]), (True, [recorded["time"]]))
        same = self.viewed.json("/api/reflection", at=recorded["time"])
        self.assertEqual(same, recorded)
        self.assertEqual(self.viewed.error("/api/reflection", at=int(recorded["time"]) - 1),
                         (404, "not found"))
        for wrong in ({"at": "now"}, {"look": 2}, {"budget": 10**9}):
            self.assertEqual(self.viewed.error("/api/reflection", **wrong),
                             (400, "invalid argument"))
        self.assertFalse(self.viewed.json("/api/reflection", look=1)["is_recorded"])


class ServerTest(unittest.TestCase):
    def test_a_server_says_what_it_does_not_tell(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            endpoint = f"unix:{folder}/engram.sock"
            server = subprocess.Popen([ENGRAM, "serve", f"{folder}/live.engram", "--listen", endpoint,
                                       "--no-system-state", "--json"], stdout=subprocess.PIPE,
                                      stderr=subprocess.DEVNULL, text=True)
            try:
                assert server.stdout
                server.stdout.readline()
                run(ENGRAM, "commit", "A/B/C/D", "--server", endpoint, "--data", '{"x": 1}')
                with Viewed(ENGRAM, "--server", endpoint) as viewed:
                    status, _, body = viewed.get("/api/forgetting", older_than="1d")
                    self.assertEqual(status, 409)
                    self.assertIn("a server does not tell", json.loads(body)["error"]["message"])
                    self.assertEqual(viewed.error("/api/forgetting", older_than="x"),
                                     (400, "invalid argument"))
                    self.assertEqual(viewed.error("/api/reflection"), (404, "not found"))
                    self.assertEqual(viewed.error("/api/reflection", look=1),
                                     (409, "failed precondition"))
            finally:
                server.terminate()
                server.wait(20)
                server.stdout.close()


if __name__ == "__main__":
    unittest.main()
