# SPDX-License-Identifier: Apache-2.0
"""What the viewer answers is what the commands say: answers_test.py ENGRAM."""

from __future__ import annotations

import array
import base64
import io
import json
import math
import pathlib
import sys
import tempfile
import threading
import unittest
from typing import Any

import numpy as np
from PIL import Image
from viewing import Viewed, make_kitchen, run

ENGRAM = sys.argv.pop()
JOINTS = "RobotState/Proprioception/robot/joints"
STEREO = "Vision/RGB/head/stereo"


def plain(value: Any) -> Any:
    """IDF's JSON without the types of numbers."""
    if isinstance(value, dict):
        if len(value) == 1 and next(iter(value)) in ("$int32", "$int64", "$float32", "$float64"):
            return next(iter(value.values()))
        return {key: plain(part) for key, part in value.items()}
    return [plain(part) for part in value] if isinstance(value, list) else value


class AnswersTest(unittest.TestCase):
    folder: tempfile.TemporaryDirectory[str]
    viewed: Viewed

    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        cls.store = make_kitchen(ENGRAM, pathlib.Path(cls.folder.name), 20, False)
        cls.viewed = Viewed(ENGRAM, str(cls.store))
        cls.info = json.loads(run(ENGRAM, "info", str(cls.store), "--json"))
        cls.entities = {one["id"]: one for one in cls.info["entities"]}

    @classmethod
    def tearDownClass(cls) -> None:
        cls.viewed.__exit__()
        cls.folder.cleanup()

    def query(self, text: str) -> Any:
        return json.loads(run(ENGRAM, "query", "--unnoted", str(self.store), text, "--json"))

    def test_info_tells_what_there_is(self) -> None:
        told = self.viewed.json("/api/info")
        self.assertEqual(told["name"], "kitchen.engram")
        self.assertEqual(told["stores"], [{"name": "kitchen.engram", "path": str(self.store)}])
        self.assertEqual(told["version"], run(ENGRAM, "--version").split()[1])
        self.assertEqual(told["entities"], len(self.entities))
        self.assertEqual(told["snapshots"],
                         sum(one["snapshots"] for one in self.entities.values()))
        self.assertEqual(int(told["first"]),
                         min(one["first_ns"] for one in self.entities.values()))
        self.assertEqual(int(told["last"]), max(one["last_ns"] for one in self.entities.values()))
        self.assertFalse(told["is_live"])
        self.assertEqual(told["max_horizon_ns"], "60000000000")

    def test_several_memories_are_asked_by_number(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            other = pathlib.Path(folder) / "other.engram"
            run(ENGRAM, "simulate", "kitchen", str(other), "--fast", "--seconds", "2")
            with Viewed(ENGRAM, str(self.store), str(other)) as viewed:
                self.assertEqual(viewed.json("/api/memories"), {"memories": [
                    {"name": "kitchen.engram", "is_live": False, "path": str(self.store)},
                    {"name": "other.engram", "is_live": False, "path": str(other)}]})
                first, second = viewed.json("/api/info"), viewed.json("/api/info", memory=1)
                self.assertEqual(first, self.viewed.json("/api/info"))
                self.assertEqual(second["name"], "other.engram")
                self.assertLess(second["snapshots"], first["snapshots"])
                self.assertEqual(viewed.error("/api/info", memory=2), (400, "invalid argument"))
                self.assertEqual(viewed.error("/api/info", memory="x"), (400, "invalid argument"))

    def test_the_tree_leads_to_each_entity(self) -> None:
        def walk(under: str, level: int) -> dict[str, Any]:
            found = {}
            told = self.viewed.json("/api/tree", under=under)
            self.assertEqual(told["under"], under)
            for child in told["children"]:
                self.assertEqual(child["level"], ["memory", "core", "provider", "entity"][level])
                if level == 3:
                    found[child["id"]] = child
                    continue
                below = walk(child["id"], level + 1)
                self.assertEqual(child["entities"], len(below))
                self.assertEqual(child["snapshots"], sum(one["snapshots"] for one in below.values()))
                self.assertEqual(int(child["first"]), min(int(one["first"]) for one in below.values()))
                found.update(below)
            return found

        found = walk("", 0)
        self.assertEqual(sorted(found), sorted(self.entities))
        for id_, told in found.items():
            known = self.entities[id_]
            for ours, theirs in (("snapshots", "snapshots"), ("raw_bytes", "raw_bytes"),
                                 ("stored_bytes", "stored_bytes"), ("latent_bytes", "latent_bytes"),
                                 ("model_bytes", "model_bytes")):
                self.assertEqual(told[ours], known[theirs], id_)
            self.assertEqual([int(told["first"]), int(told["last"])],
                             [known["first_ns"], known["last_ns"]])
            self.assertEqual(told["forms"], {"recorded": known["snapshots"], "latent": 0,
                                             "augmented": 0})
        self.assertIn("image", found[STEREO]["kinds"])
        self.assertIn("number", found[JOINTS]["kinds"])
        depth = next(one for one in found if one.startswith("Vision/Depth"))
        self.assertIn("depth", found[depth]["kinds"])
        self.assertNotIn("image", found[depth]["kinds"])
        self.assertEqual(self.viewed.error("/api/tree", under=JOINTS), (400, "invalid argument"))
        self.assertEqual(self.viewed.error("/api/tree", under="Nothing"), (404, "not found"))

    def test_names_are_found(self) -> None:
        told = self.viewed.json("/api/find", text="JOINTS")
        self.assertEqual(told, {"found": [one for one in sorted(self.entities) if "joints" in one.lower()],
                                "more": False})
        told = self.viewed.json("/api/find", text="", max=2)
        self.assertEqual((len(told["found"]), told["more"]), (2, True))

    def test_a_tree_comes_as_deep_as_is_asked_for(self) -> None:
        whole = self.viewed.json("/api/tree", depth=4)["children"]
        for memory in whole:
            for core in memory["children"]:
                self.assertEqual(self.viewed.json("/api/tree", under=core["id"], depth=2)["children"],
                                 core["children"])
        for wrong in ("0", "5", "deep"):
            self.assertEqual(self.viewed.error("/api/tree", depth=wrong), (400, "invalid argument"))

    def test_steps_lead_from_snapshot_to_snapshot(self) -> None:
        times = [one["time_ns"] for one in self.query(f"{JOINTS} @ all")["entities"][0]["snapshots"]]
        for at, by, needed in ((times[5], 1, times[6]), (times[5], -1, times[4]),
                               (times[5] + 1, -1, times[5]), (times[5] - 1, 1, times[5]),
                               (times[5], 10, times[15]), (times[5], -10, times[0]),
                               (times[-1], 1, times[-1]), (times[-1] + 10**9, -2, times[-2])):
            self.assertEqual(int(self.viewed.json("/api/step", entity=JOINTS, at=at, by=by)["time"]),
                             needed, (at, by))
        self.assertEqual(self.viewed.error("/api/step", entity=JOINTS, at=0, by=0),
                         (400, "invalid argument"))

    def test_density_counts_each_snapshot_once(self) -> None:
        first = min(one["first_ns"] for one in self.entities.values())
        last = max(one["last_ns"] for one in self.entities.values()) + 1
        names = [JOINTS, STEREO]
        status, headers, body = self.viewed.get("/api/density", entity=names, **{"from": first},
                                                to=last, pixels=7)
        self.assertEqual((status, headers["content-type"]), (200, "application/octet-stream"))
        counts = np.frombuffer(body, "<u4").reshape(2, 3, 7)
        for lane, name in enumerate(names):
            ids = self.query(f"?ids {name} @ all")["ids"]
            times = sorted({id_.split("/")[4] for id_ in ids})
            self.assertEqual(counts[lane, 0].sum(), len(times))
            self.assertEqual(counts[lane, 1:].sum(), 0)
        # A segment is the sum of what lies below it.
        _, _, body = self.viewed.get("/api/density", entity="Objects", **{"from": first}, to=last,
                                     pixels=3)
        self.assertEqual(np.frombuffer(body, "<u4").sum(), sum(
            one["snapshots"] for id_, one in self.entities.items() if id_.startswith("Objects/")))
        self.assertEqual(self.viewed.error("/api/density", entity="Object", **{"from": 0}, to=9,
                                           pixels=3), (404, "not found"))
        # Half of the time, as a query has it.
        middle = (first + last) // 2
        _, _, body = self.viewed.get("/api/density", entity=JOINTS, **{"from": first}, to=middle,
                                     pixels=1)
        ids = self.query(f"?ids {JOINTS} @ time:{first}..{middle - 1}")["ids"]
        self.assertEqual(array.array("I", body)[0], len({id_.split("/")[4] for id_ in ids}))

    def test_series_are_what_snapshots_hold(self) -> None:
        members = self.viewed.json("/api/members", entity=JOINTS)["members"]
        numbers = [one for one in members if one["kind"] == "number"]
        self.assertGreater(len(numbers), 20)
        path = numbers[3]["path"]
        name, index = path[:-1].split("[")
        known = self.entities[JOINTS]
        first, last = known["first_ns"], known["last_ns"] + 1
        status, headers, body = self.viewed.get(
            "/api/series", entity=JOINTS, path=[path, "none"], **{"from": first}, to=last,
            pixels=5, budget=5000)
        self.assertEqual(status, 200)
        self.assertEqual(headers["x-engram-read"], headers["x-engram-total"])
        self.assertEqual(int(headers["x-engram-total"]), known["snapshots"])
        drawn = np.frombuffer(body, "<f4").reshape(2, 3, 5)
        self.assertTrue(np.isnan(drawn[1]).all())
        values = []
        for snapshot in self.query(f"{JOINTS} @ all")["entities"][0]["snapshots"]:
            part = snapshot["instances"][0]["data"]
            for key in name.split("/"):
                part = part[key]
            values.append((snapshot["time_ns"], number_of(part["$ndarray"], int(index))))
        for pixel in range(5):
            begin = first + (last - first) * pixel // 5
            end = first + (last - first) * (pixel + 1) // 5
            inside = [np.float32(value) for time, value in values if begin <= time < end]
            np.testing.assert_array_equal(drawn[0, :, pixel],
                                          [min(inside), max(inside), inside[-1]])

    def test_a_moment_is_what_a_query_says(self) -> None:
        known = self.entities[JOINTS]
        at = (known["first_ns"] + known["last_ns"]) // 2
        told = self.viewed.json("/api/moment", entity=JOINTS, at=at)
        found = self.query(f"{JOINTS} @ at-or-before:{at}")["entities"][0]["snapshots"][0]
        self.assertEqual(told["id"], found["id"])
        self.assertEqual(int(told["time"]), found["time_ns"])
        self.assertEqual(told["source"], "recorded")
        metadata = told["instances"][0]["metadata"]
        self.assertEqual(int(metadata["created"]), found["instances"][0]["created_ns"])
        self.assertEqual(metadata["provider"], found["instances"][0]["provider"])
        data = told["instances"][0]["data"]
        self.assertEqual(set(data), set(found["instances"][0]["data"]))
        next_ = self.viewed.json("/api/moment", entity=JOINTS, at=told["next"], which="exact")
        self.assertEqual(next_["previous"], told["time"])
        first = self.viewed.json("/api/moment", entity=JOINTS, at=known["first_ns"], which="exact")
        self.assertIsNone(first["previous"])
        nearest = self.viewed.json("/api/moment", entity=JOINTS, at=at + 1, which="nearest")
        self.assertIn(nearest["time"], (told["time"], told["next"]))
        self.assertEqual(self.viewed.error("/api/moment", entity=JOINTS, at=at + 1, which="exact"),
                         (404, "not found"))
        self.assertEqual(self.viewed.error("/api/moment", entity=JOINTS, at=0), (404, "not found"))

    def test_the_future_is_what_predict_says(self) -> None:
        horizons = [200_000_000, 400_000_000]
        told = self.viewed.json("/api/predict", entity=JOINTS, horizon=",".join(map(str, horizons)))
        found = self.query(f"{JOINTS} @ +200ms, +400ms")["entities"][0]["snapshots"]
        self.assertEqual([one["source"] for one in told], ["predicted"] * 2)
        for one, known, horizon in zip(told, found, horizons, strict=True):
            self.assertEqual(int(one["time"]), known["time_ns"])
            self.assertEqual(one["engine"], known["predictor"])
            self.assertEqual(int(one["horizon"]), horizon)
            self.assertEqual(int(one["from"]), self.entities[JOINTS]["last_ns"])
            error = known["instances"][0]["expected_error"]
            self.assertEqual(one["error"], error)
            self.assertEqual(one["expected_error"], error["rmse"])
            self.assertGreaterEqual(one["bound"], one["expected_error"])
            self.assertEqual([part["path"] for part in one["members"]],
                             [part["path"] for part in known["instances"][0]["members"]])
        past = self.entities[JOINTS]["first_ns"] + 10**10
        back = self.viewed.json("/api/predict", entity=JOINTS, at=past, horizon=horizons[0])
        self.assertLess(int(back[0]["time"]), past + horizons[0] + 1)
        at = int(told[0]["time"])
        ahead = self.viewed.json("/api/moment", entity=JOINTS, at=at, which="predict")
        self.assertEqual((ahead["source"], int(ahead["time"])), ("predicted", at))
        for wrong in ("0", "-1", "nan", "1,", "", "1e9", "9" * 30, ",".join(["1"] * 65)):
            self.assertEqual(self.viewed.error("/api/predict", entity=JOINTS, horizon=wrong),
                             (400, "invalid argument"), wrong)

    def test_moments_do_not_wait_for_predictions(self) -> None:
        shown = 0
        with Viewed(ENGRAM, str(self.store)) as viewed:
            # The first prediction of joints learns from their past, which takes a second.
            waiting = threading.Thread(target=lambda: viewed.json(
                "/api/predict", entity=JOINTS, horizon=400_000_000))
            waiting.start()
            while waiting.is_alive():
                viewed.json("/api/moment", entity=JOINTS, at=self.entities[JOINTS]["last_ns"])
                shown += 1
        # Two may come before the prediction is asked for, and one waits until it is there.
        self.assertGreater(shown, 10)

    def test_queries_are_answered_as_the_command_does(self) -> None:
        for text in (f"{JOINTS} @ latest:2", f"?ids {JOINTS} @ latest:3",
                     "Skill @ all ; Speech @ all", f"{STEREO} @ latest"):
            self.assertEqual(self.viewed.json("/api/query", q=text), self.query(text), text)
        self.assertEqual(self.viewed.error("/api/query", q="("), (400, "invalid argument"))
        self.assertEqual(self.viewed.error("/api/query", q="Nothing"), (404, "not found"))
        self.assertEqual(self.viewed.error("/api/query", q=f"{STEREO} @ all"),
                         (413, "resource exhausted"))

    def test_images_are_the_recorded_ones(self) -> None:
        moment = self.viewed.json("/api/moment", entity=STEREO, at=self.entities[STEREO]["last_ns"])
        image = moment["instances"][0]["data"]["image"]["$image"]
        self.assertEqual(image["path"], "image")
        status, headers, body = self.viewed.get("/api/image", id=moment["id"], path="image",
                                                **{"as": "png"})
        self.assertEqual((status, headers["content-type"]), (200, "image/png"))
        self.assertEqual(headers["x-engram-source"], "recorded")
        with tempfile.TemporaryDirectory() as folder:
            run(ENGRAM, "query", "--unnoted", str(self.store), f"{STEREO} @ latest", "--save", folder)
            saved = sorted(pathlib.Path(folder).rglob("*.0.image.png"))
            self.assertEqual(pixels_of(saved[0].read_bytes()).tobytes(), pixels_of(body).tobytes())
        status, headers, body = self.viewed.get("/api/image", id=moment["id"] + "/1", path="image",
                                                **{"as": "jpeg"})
        self.assertEqual((status, headers["content-type"]), (200, "image/jpeg"))
        self.assertEqual(pixels_of(body).shape, (image["height"], image["width"], 3))
        target = f"/api/image?id={moment['id'].replace(' ', '%20')}&path=image"
        status, headers, _ = self.viewed.ask(target)
        self.assertEqual(status, 200)
        status, _, body = self.viewed.ask(target, headers={"If-None-Match": headers["etag"]})
        self.assertEqual((status, body), (304, b""))
        self.assertEqual(self.viewed.error("/api/image", id=moment["id"], path="image",
                                           form="latent"), (404, "not found"))
        self.assertEqual(self.viewed.error("/api/image", id=moment["id"], path="none"),
                         (404, "not found"))
        self.assertEqual(self.viewed.error("/api/image", id=STEREO, path="image"),
                         (400, "invalid argument"))

    def test_depth_is_told_with_its_range(self) -> None:
        depth = next(one for one in self.entities if "depth" in one.lower())
        moment = self.viewed.json("/api/moment", entity=depth, at=self.entities[depth]["last_ns"])
        status, headers, body = self.viewed.get("/api/image", id=moment["id"], path="depth",
                                                **{"as": "png"})
        self.assertEqual(status, 200)
        self.assertLess(float(headers["x-engram-min"]), float(headers["x-engram-max"]))
        self.assertEqual(pixels_of(body).max(), 255)

    def test_depth_becomes_points(self) -> None:
        depth = next(one for one in self.entities if "depth" in one.lower())
        moment = self.viewed.json("/api/moment", entity=depth, at=self.entities[depth]["last_ns"])
        camera = {"fx": 100, "fy": 100, "cx": 63.5, "cy": 63.5, "unit": 0.001}
        status, headers, body = self.viewed.get("/api/cloud", id=moment["id"], path="depth", **camera)
        self.assertEqual(status, 200)
        points = np.frombuffer(body, "<f4").reshape(-1, 3)
        self.assertEqual(len(points), int(headers["x-engram-points"]))
        self.assertEqual(len(points), int(headers["x-engram-total"]))
        self.assertGreater(len(points), 10000)
        # The walls of the kitchen are a few metres away, and each point lies in its pixel's direction.
        self.assertTrue(((points[:, 2] > 0.1) & (points[:, 2] < 12)).all())
        columns = points[:, 0] / points[:, 2] * 100 + 63.5
        self.assertLess(np.abs(columns - np.round(columns)).max(), 0.01)
        status, headers, body = self.viewed.get("/api/cloud", id=moment["id"], path="depth", max=100, **camera)
        self.assertEqual((len(body), headers["x-engram-points"]), (1200, "100"))
        self.assertEqual(int(headers["x-engram-total"]), len(points))
        for wrong in ({"fx": 0}, {"fy": "nan"}, {"unit": -1}, {"max": 500_001}, {"max": 0}):
            self.assertEqual(self.viewed.error("/api/cloud", id=moment["id"], path="depth", **{**camera, **wrong}),
                             (400, "invalid argument"), wrong)
        self.assertEqual(self.viewed.error("/api/cloud", id=moment["id"], path="depth"), (400, "invalid argument"))
        self.assertEqual(self.viewed.error("/api/cloud", id=moment["id"], path="view"), (404, "not found"))

    def test_similar_moments_are_those_of_the_command(self) -> None:
        moment = self.viewed.json("/api/moment", entity=STEREO, at=self.entities[STEREO]["last_ns"])
        told = self.viewed.json("/api/similar", id=moment["id"], k=3)
        found = json.loads(run(ENGRAM, "similar", str(self.store), moment["id"], "-k", "3", "--json"))
        self.assertEqual([(one["id"], one["distance"]) for one in told["found"]],
                         [(one["id"], one["distance"]) for one in found["moments"]])

    def test_questions_are_answered_as_the_command_does(self) -> None:
        for question in ("What were you asked to do?", "What did you do?", "Where is the elephant?"):
            told = self.viewed.json("/api/ask", q=question)
            found = json.loads(run(ENGRAM, "ask", str(self.store), question, "--json"))
            self.assertEqual({**told, "took_ms": 0}, {**found, "took_ms": 0})
            self.assertEqual(told["value"]["kind"] == "unknown", "elephant" in question)
        first, last = self.entities[JOINTS]["first_ns"], self.entities[JOINTS]["last_ns"]
        told = self.viewed.json("/api/tell", **{"from": first, "until": last})
        found = json.loads(run(ENGRAM, "tell", str(self.store), "--json"))
        self.assertEqual(told["sentences"], found["sentences"])
        self.assertTrue(told["sentences"])
        # As of the beginning nothing was done yet.
        then = self.viewed.json("/api/ask", q="What did you do last?", now=first)
        self.assertNotEqual(then["value"], self.viewed.json("/api/ask", q="What did you do last?")["value"])
        self.assertEqual(self.viewed.error("/api/ask"), (400, "invalid argument"))
        self.assertEqual(self.viewed.error("/api/ask", q="x" * 20_000)[0], 400)
        self.assertEqual(self.viewed.error("/api/tell", **{"from": last, "until": first}),
                         (400, "invalid argument"))

    def test_a_map_has_moments_of_the_whole_time(self) -> None:
        for entity, coded_by in ((JOINTS, "numbers"), (STEREO, "images")):
            told = self.viewed.json("/api/map", entity=entity, max=50)
            count = min(50, told["known"])
            self.assertEqual(told["coded_by"], coded_by)
            self.assertEqual([len(told[name]) for name in ("times", "x", "y", "recordings")],
                             [count] * 4)
            self.assertGreater(told["known"], 0.9 * self.entities[entity]["snapshots"])
            self.assertEqual(sorted(told["times"], key=int), told["times"])
            self.assertTrue(0.1 < told["explained"] <= 1.0001, told["explained"])
            self.assertGreater(np.std(told["x"]), np.std(told["y"]))
        self.assertEqual(self.viewed.error("/api/map", entity=JOINTS, max=0),
                         (400, "invalid argument"))
        self.assertEqual(self.viewed.error("/api/map", entity="A/B/C/D"), (404, "not found"))

    def test_quality_needs_both_forms(self) -> None:
        told = self.viewed.json("/api/quality", entity=STEREO)
        self.assertEqual((told["compared"], told["counts"], told["worst"]), (0, [], []))
        self.assertEqual(self.viewed.error("/api/quality", entity="A/B/C/D"), (404, "not found"))

    def test_links_lead_there_and_back(self) -> None:
        moment = self.viewed.json("/api/moment", entity=STEREO, at=self.entities[STEREO]["last_ns"])
        told = self.viewed.json("/api/links", id=moment["id"])
        joints = next(one["id"] for one in told["to"] if one["path"] == "joints")
        self.assertEqual(moment["instances"][0]["data"]["joints"], {"$link": joints})
        back = self.viewed.json("/api/links", id="/".join(joints.split("/")[:5]))
        self.assertIn(moment["id"], back["from"])

    def test_nights_tell_what_info_does(self) -> None:
        told = self.viewed.json("/api/nights")["entities"]
        for one in told:
            known = dict(self.entities[one["id"]])
            del known["rate_hz"]
            self.assertEqual(one, known)

    def test_a_head_has_no_body(self) -> None:
        status, headers, body = self.viewed.ask("/api/info", "HEAD")
        self.assertEqual((status, body), (200, b""))
        self.assertGreater(int(headers["content-length"]), 100)

    def test_the_page_is_there(self) -> None:
        status, headers, body = self.viewed.ask("/")
        self.assertEqual(status, 200)
        self.assertIn(b"<!doctype html>", body.lower())
        self.assertEqual(headers["cache-control"], "no-store")

    def test_nothing_is_noted_or_changed(self) -> None:
        self.viewed.json("/api/moment", entity=JOINTS, at=self.entities[JOINTS]["last_ns"])
        self.assertFalse(any((self.store / "access").glob("*"))
                         if (self.store / "access").exists() else False)


def number_of(array_json: dict[str, Any], index: int) -> float:
    if "data" in array_json:
        value = plain(array_json["data"][index])
        return math.nan if value == "nan" else value
    return float(np.frombuffer(base64.b64decode(array_json["base64"]),
                               np.dtype(array_json["type"]).newbyteorder("<"))[index])


def pixels_of(file: bytes) -> Any:
    return np.asarray(Image.open(io.BytesIO(file)))


if __name__ == "__main__":
    unittest.main()
