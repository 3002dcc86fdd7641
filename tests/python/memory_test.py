# SPDX-License-Identifier: Apache-2.0
"""Reading a memory from Python: memory_test.py ENGRAM, the program that makes one to read."""

import datetime
import gc
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading
import unittest

import numpy as np

import engram
from engram import errors, idf

ENGRAM = sys.argv.pop()
CAMERA = "Vision/RGB/head/cam"
JOINTS = "RobotState/Proprioception/robot/joints"
START = 1_600_000_000 * 10**9
FRAMES = 40  # At 10 Hz, each as it came.


def record(folder):
    def run(*words):
        subprocess.run([ENGRAM, *map(str, words)], check=True, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)

    video, table, store = folder / "scene.mp4", folder / "scene.csv", folder / "robot.engram"
    run("simulate", "scene", "--seconds", FRAMES / 10, "--rate", 10, "--width", 64, "--height", 48,
        "--video", video, "--table", table)
    run("import", "--video", video, "--table", table, "--entity", CAMERA, "--state-entity", JOINTS,
        "--all", "--start", START, store)
    return store


class Reading(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = record(pathlib.Path(cls.folder.name))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def setUp(self):
        self.memory = engram.open(self.path)
        self.addCleanup(self.memory.close)

    def test_entities_are_listed_and_shown(self):
        self.assertEqual(self.memory.entities, [JOINTS, CAMERA])
        self.assertEqual([entity.name for entity in self.memory], [JOINTS, CAMERA])
        self.assertIn(CAMERA, self.memory)
        self.assertNotIn("a/b/c/d", self.memory)
        self.assertEqual(len(self.memory), 2)
        self.assertEqual(len(self.memory[CAMERA]), FRAMES)
        self.assertIn("2 entities", repr(self.memory))
        self.assertIn(f"<Entity {CAMERA}: {FRAMES} snapshots, 2020-09-13T12:26:40",
                      repr(self.memory[CAMERA]))

    def test_snapshots_come_in_order_whatever_the_ends(self):
        camera = self.memory[CAMERA]
        times = [snapshot.time for snapshot in camera.snapshots()]
        self.assertEqual(times, sorted(set(times)))
        self.assertEqual((len(times), times[0], times[-1]), (FRAMES, camera.first, camera.last))
        self.assertEqual([one.time for one in camera], times)
        for first, last in ((0, FRAMES - 1), (3, 3), (5, 21), (16, 32)):
            some = [one.time for one in camera.snapshots(times[first], times[last])]
            self.assertEqual(some, times[first : last + 1])
        self.assertEqual(list(camera.snapshots(camera.last + 1)), [])
        self.assertEqual([one.time for one in camera.latest(3)], times[-3:])
        self.assertEqual([one.time for one in camera.snapshots(None, times[4] - 1)], times[:4])

    def test_images_are_views_that_keep_their_owner(self):
        snapshot = self.memory[CAMERA].at(START)
        image = snapshot.image
        self.assertEqual((image.shape, image.dtype), ((48, 64, 3), np.uint8))
        with self.assertRaises(ValueError):
            image[0, 0, 0] = 1
        self.assertFalse(image.flags.owndata)
        self.assertTrue(np.shares_memory(image, snapshot.image))
        copy = image.copy()
        self.memory.close()
        del snapshot
        gc.collect()
        np.testing.assert_array_equal(image, copy)
        self.assertGreater(copy.std(), 1)

    def test_values_and_metadata_are_those_of_the_store(self):
        snapshot = self.memory[JOINTS].latest()[0]
        self.assertEqual(snapshot.source, "recorded")
        self.assertEqual((snapshot.model, snapshot.horizon, snapshot.error), ("", 0, None))
        self.assertIsInstance(snapshot.value, dict)
        self.assertTrue(snapshot.value["camera"].startswith(CAMERA))
        instance = snapshot.instances[0]
        self.assertEqual((instance.index, instance.created), (0, snapshot.time))
        self.assertEqual(instance.confidence, 1.0)
        with self.assertRaises(errors.NotFoundError):
            _ = snapshot.image

    def test_values_are_those_that_the_program_tells(self):
        """Numbers of all kinds, arrays, lists and texts, from a bag; by way of JSON."""
        store = pathlib.Path(self.folder.name) / "bag.engram"
        bag = pathlib.Path(__file__).parents[1] / "golden" / "rosbag" / "none.bag"
        subprocess.run([ENGRAM, "import", "--from", bag, store], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        told = json.loads(subprocess.run([ENGRAM, "query", store, "@ all", "--json"], check=True,
                                         stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout)
        with engram.open(store) as memory:
            found = memory.query("@ all")
        self.assertGreater(len(found), 9)
        self.assertEqual([entity["id"] for entity in told["entities"]], list(found))
        for entity in told["entities"]:
            expected = [(one["time_ns"], idf.from_json(json.dumps(one["instances"][0]["data"])))
                        for one in entity["snapshots"]]
            read = [(one.time, one.value) for one in found[entity["id"]]]
            self.assertEqual([time for time, _ in read], [time for time, _ in expected])
            for (_, one), (_, other) in zip(read, expected):
                self.assertTrue(idf.equal(one, other), f"{entity['id']}: {one} and {other}")

    def test_times_are_taken_in_every_form(self):
        camera = self.memory[CAMERA]
        for time in (START, np.int64(START), np.datetime64(START, "ns"), "2020-09-13T12:26:40",
                     "2020-09-13 12:26:40Z", np.datetime64("2020-09-13T12:26:40"),
                     datetime.datetime(2020, 9, 13, 12, 26, 40),
                     datetime.datetime(2020, 9, 13, 14, 26, 40, tzinfo=datetime.timezone(
                         datetime.timedelta(hours=2)))):
            self.assertEqual(camera.at(time).time, START, time)
        self.assertEqual(camera.at(START).datetime, np.datetime64("2020-09-13T12:26:40", "ns"))
        for time in (1.5, True, None, "yesterday", np.datetime64("NaT")):
            with self.assertRaises(ValueError, msg=time):
                camera.at(time)

    def test_the_future_is_predicted(self):
        camera = self.memory[CAMERA]
        future = camera.ahead(0.2)
        self.assertEqual((future.source, future.horizon), ("predicted", 200_000_000))
        self.assertEqual(future.time, camera.last + 200_000_000)
        self.assertEqual(future.image.shape, (48, 64, 3))
        window = camera.window(camera.last, [-0.2, 0.0, np.timedelta64(200, "ms")])
        self.assertEqual([one.source for one in window], ["recorded", "recorded", "predicted"])
        self.assertEqual(camera.nearest(START + 149_000_000).time, START + 100_000_000)

    def test_queries_take_the_text_form(self):
        found = self.memory.query("Vision @ latest:2; RobotState @ latest")
        self.assertEqual({name: len(snapshots) for name, snapshots in found.items()},
                         {JOINTS: 1, CAMERA: 2})

    def test_errors_have_classes_and_say_what_was_needed(self):
        with self.assertRaises(errors.NotFoundError) as raised:
            engram.open("/nowhere/at.all")
        self.assertIn("/nowhere/at.all", str(raised.exception))
        with self.assertRaises(LookupError):
            self.memory["Vision/RGB/head/other"]
        with self.assertRaises(errors.NotFoundError):
            self.memory[CAMERA].at(START + 1)
        with self.assertRaises(errors.InvalidArgumentError):
            self.memory["Vision"]
        with self.assertRaises(errors.InvalidArgumentError):
            self.memory.query("Vision @ sometimes")
        with self.assertRaises(ValueError):
            engram.open(self.path, prefer="both")
        self.memory.close()
        self.memory.close()
        with self.assertRaises(errors.FailedPreconditionError):
            self.memory.query("Vision")
        with self.assertRaises(AttributeError):
            _ = engram.nothing

    @unittest.skipUnless(shutil.which("mypy"), "mypy is not installed")
    def test_types_are_those_that_are_stated(self):
        checked = subprocess.run(
            ["mypy", "--strict", "--cache-dir", self.folder.name + "/cache",
             pathlib.Path(__file__).parents[2] / "python" / "engram"],
            stdout=subprocess.PIPE, text=True, check=False)
        self.assertEqual(checked.returncode, 0, checked.stdout)

    def test_threads_may_ask_together(self):
        camera = self.memory[CAMERA]
        expected = [one.image.sum() for one in camera]
        found = {}

        def read(name):
            found[name] = [one.image.sum() for one in camera]

        threads = [threading.Thread(target=read, args=(name,)) for name in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(list(found.values()), [expected] * 4)

    def test_it_closes_at_the_end_of_a_block(self):
        with engram.open(self.path) as memory:
            entity = memory[CAMERA]
        with self.assertRaises(errors.FailedPreconditionError):
            entity.latest()


if __name__ == "__main__":
    unittest.main()
