# SPDX-License-Identifier: Apache-2.0
"""Committing to a live memory, here and in a server: live_test.py ENGRAM, the program that serves."""

import os
import pickle
import sys
import threading
import time
import unittest

import numpy as np
from live_doors import CUP, ENOUGH, START, ConnectedDoor, OpenedDoor

import engram
from engram import errors, idf
from engram.idf import types

ConnectedDoor.program = sys.argv.pop()


class Committing:
    """Of both."""

    def test_what_is_committed_can_be_asked_for_at_once(self):
        image = np.arange(24, dtype=np.uint8).reshape(2, 4, 3)
        value = {"image": image, "text": "ü", "list": [1, None, True], "f": np.float32(0.1),
                 "int": np.int32(5), "inner": {"deep": np.zeros((0, 3))}}
        before = time.time_ns()
        self.memory.commit(CUP, value, START, confidence=0.25)
        image += 1  # It was copied.
        found = self.memory[CUP].at(START)
        expected = value | {"image": image - 1, "list": [np.int64(1), None, True]}
        self.assertTrue(idf.equal(found.value, expected), found.value)
        instance = found.instances[0]
        self.assertEqual((found.source, instance.confidence, instance.created),
                         ("recorded", 0.25, START))
        self.assertLessEqual(before, instance.sent)
        self.assertLessEqual(instance.sent, instance.arrived)
        with self.assertRaises(ValueError):
            found.image[0, 0, 0] = 1

    def test_a_time_is_now_unless_it_is_said(self):
        before = time.time_ns()
        self.memory.commit(CUP, 1.5, durability="memory")
        self.memory.commit("Speech/Text/human/said", "Hi", np.datetime64("2020-01-01"),
                           durability="journal")
        self.assertTrue(before <= self.memory[CUP].last <= time.time_ns())
        self.assertEqual(self.memory.entities, [CUP, "Speech/Text/human/said"])

    def test_several_updates_are_one_commit_or_none(self):
        self.memory.commit_all(engram.Update(CUP, i, START + i) for i in range(5))
        self.assertEqual(len(self.memory[CUP]), 5)
        with self.assertRaises(errors.InvalidArgumentError):
            self.memory.commit_all([engram.Update(CUP, 7, START + 7),
                                    engram.Update("Objects", 8, START + 8)])
        self.assertEqual(len(self.memory[CUP]), 5)

    def test_the_future_follows_what_was_just_committed(self):
        for i in range(30):
            self.commit(i)
        soon = self.memory[CUP].ahead(0.4)
        self.assertEqual((soon.source, soon.horizon), ("predicted", 400_000_000))
        self.assertAlmostEqual(soon.value["x"], 3.1, places=6)
        self.commit(30, x=-1.0)
        self.assertEqual(self.memory[CUP].ahead(0.4).time, START + 32 * 200_000_000)

    def test_values_are_held_against_their_type(self):
        of = types.Object(name="Cup", members=(types.Member("x", types.Double(unit="m")),))
        self.memory.declare("Objects/Things", of)
        self.memory.commit(CUP, {"x": np.float32(0.5)}, START)
        self.assertIsInstance(self.memory[CUP].at(START).value["x"], np.float64)
        with self.assertRaisesRegex(errors.InvalidArgumentError, "needs"):
            self.memory.commit(CUP, "a text", START + 1)
        extended = types.Object(name="Mug", base=of,
                                members=(types.Member("handle", types.Bool(optional=True)),))
        self.memory.declare("Objects/Things/kitchen", extended)
        with self.assertRaises(errors.InvalidArgumentError):
            self.memory.declare("Objects/Things/hall", types.String())

    def test_generated_classes_declare_and_commit(self):
        class Cup(idf.TypedObject):
            def __init__(self, x):
                self.x = x

            @staticmethod
            def idf_type():
                return types.Object(name="Cup", python=Cup,
                                    members=(types.Member("x", types.Double()),))

        self.memory.declare("Objects/Things", Cup)
        self.memory.commit(CUP, Cup(2), START)
        self.assertTrue(idf.equal(self.memory[CUP].at(START).value, {"x": np.float64(2)}))

    def test_threads_commit_and_ask_together(self):
        def work(place):
            entity = f"Objects/Things/kitchen/cup{place}"
            for i in range(50):
                self.memory.commit(entity, {"x": float(i)}, START + i, durability="memory")
                self.assertEqual(self.memory[entity].latest()[0].value["x"], i)

        failures = []

        def guarded(place):
            try:
                work(place)
            except Exception as error:  # noqa: BLE001
                failures.append(error)

        threads = [threading.Thread(target=guarded, args=(place,)) for place in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(failures, [])
        self.assertEqual([len(one) for one in self.memory], [50] * 4)

    def test_wrong_commits_are_refused_by_name(self):
        wrong = [
            dict(entity="Objects", value=1), dict(entity="", value=1), dict(entity=7, value=1),
            dict(entity=None, value=1), dict(entity=CUP, value=object()),
            dict(entity=CUP, value={"x": {1: 2}}), dict(entity=CUP, value=2**70),
            dict(entity=CUP, value=1, confidence="much"), dict(entity=CUP, value=1, time=1.5),
            dict(entity=CUP, value=1, time="soon"), dict(entity=CUP, value=1, durability="ever"),
            dict(entity=CUP, value=1, durability=7), dict(entity=CUP, value=np.array([object()])),
            dict(entity=CUP, value=1, time=2**70),
        ]
        for arguments in wrong:
            with self.subTest(**arguments), self.assertRaises(errors.InvalidArgumentError):
                self.memory.commit(**arguments)
        with self.assertRaisesRegex(errors.InvalidArgumentError, f"'{CUP}': found confidence"):
            self.memory.commit(CUP, 1, confidence=[])
        self.assertEqual(self.memory.entities, [])

    def test_wrong_watches_and_types_are_refused(self):
        for arguments in (dict(names="("), dict(names=[5]), dict(queue=-1), dict(queue="2"),
                          dict(max_bytes=2**40)):
            with self.subTest(**arguments), self.assertRaises(errors.InvalidArgumentError):
                self.memory.watch(**arguments)
        for segment, of in (("Objects/Things", "Cup"), ("Objects", types.Int()),
                            ("Objects/Things", int), (7, types.Int()), (CUP, types.Int())):
            with self.subTest(segment=segment), self.assertRaises(errors.InvalidArgumentError):
                self.memory.declare(segment, of)

    def test_an_earlier_moment_is_predicted_from(self):
        for i in range(20):
            self.commit(i)
        moment = START + 9 * 200_000_000
        next_one = self.memory[CUP].predict([0.4, 0.2], at=moment + 1, engine="line")
        self.assertEqual([one.time - moment for one in next_one], [400_000_000, 200_000_000])
        self.assertAlmostEqual(next_one[1].value["x"], 1.0)
        with self.assertRaisesRegex(errors.NotFoundError, "at or before"):
            self.memory[CUP].predict(0.2, at=START - 1)
        with self.assertRaisesRegex(errors.InvalidArgumentError, "no other entity"):
            self.memory[CUP].predict(0.2, plan=CUP)

    def test_engines_of_a_moment_see_nothing_after_it(self):
        for i in range(6):
            self.commit(i)
        then = self.memory[CUP].engines(0.2, at=START)
        self.assertEqual([one.predictions for one in then], [0] * len(then))
        with self.assertRaisesRegex(errors.NotFoundError, "at or before"):
            self.memory[CUP].engines(0.2, at=START - 1)

    def test_a_closed_memory_answers_nothing(self):
        self.commit(1)
        cup = self.memory[CUP]
        self.memory.close()
        self.memory.close()
        for call in (lambda: self.memory.query("Objects"), lambda: self.memory.entities,
                     lambda: self.memory[CUP], cup.latest, lambda: cup.ahead(0.2),
                     lambda: cup.engines(0.2), lambda: self.memory.commit(CUP, 1),
                     lambda: self.memory.declare("A/b", types.Int()), self.memory.watch):
            with self.assertRaisesRegex(errors.FailedPreconditionError, "closed"):
                call()

    def test_a_forked_process_is_told_to_open_its_own(self):
        watch = self.memory.watch()
        self.addCleanup(watch.close)
        out, into = os.pipe()
        child = os.fork()
        if child == 0:
            for call in (lambda: self.memory.entities, lambda: watch.next(0)):
                try:
                    call()
                except errors.FailedPreconditionError as error:
                    os.write(into, str(error).encode())
            self.memory.close()
            del self.memory, watch
            os._exit(0)
        os.close(into)
        os.waitpid(child, 0)
        self.assertEqual(os.read(out, 1000).count(b"another process"), 2)
        os.close(out)
        self.commit(1)
        self.assertEqual(watch.next(ENOUGH).time, self.memory[CUP].last)


class Opened(Committing, OpenedDoor, unittest.TestCase):
    def test_one_program_has_a_live_memory_and_any_reads_it(self):
        with self.assertRaises(errors.FailedPreconditionError):
            engram.open(self.path, read_only=False)
        self.commit(1)
        with engram.open(self.path) as reader:
            self.assertEqual(len(reader[CUP]), 1)
            for call in (lambda: reader.commit(CUP, 1), reader.watch,
                         lambda: reader.declare("A/b", types.Int())):
                with self.assertRaisesRegex(errors.FailedPreconditionError, "read_only=False"):
                    call()
        with self.assertRaises(errors.FailedPreconditionError):
            pickle.dumps(self.memory)

    def test_what_it_held_is_in_its_store_when_it_is_closed(self):
        for i in range(10):
            self.memory.commit(CUP, {"x": i}, START + i, durability="memory")
        self.assertIn("live", repr(self.memory))
        self.assertIn("10 snapshots", repr(self.memory[CUP]))
        self.memory.close()
        self.assertTrue(engram.check(self.path)["clean"])
        with engram.open(self.path, read_only=False) as again:
            self.assertEqual(len(again[CUP]), 10)
            self.assertEqual(again.models(), [])
            self.assertEqual(again[CUP].summary(),
                             {"snapshots": 10, "first": START, "last": START + 9})

    def test_options_are_checked(self):
        for arguments in (dict(prefer="both"), dict(working_bytes=-1), dict(working_bytes="1 GB"),
                          dict(config=5)):
            with self.subTest(**arguments), self.assertRaises(errors.InvalidArgumentError):
                engram.open(self.folder / "other", read_only=False, **arguments)
        with self.assertRaisesRegex(errors.EngramError, "absent.yaml"):
            engram.open(self.folder / "other", read_only=False, config=self.folder / "absent.yaml")
        with engram.open(self.folder / "short", read_only=False, horizon=1) as memory:
            memory.commit(CUP, {"x": 1.0}, START)
            memory.commit(CUP, {"x": 1.0}, START + 10**9)
            with self.assertRaises(errors.InvalidArgumentError):
                memory[CUP].ahead(2)

    def test_the_files_of_its_store_are_read_beside_it(self):
        for i in range(5):
            self.commit(i)
        self.assertTrue(engram.check(self.memory)["clean"])
        with self.assertRaisesRegex(errors.NotFoundError, "no model"):
            _ = self.memory[CUP].model
        self.assertEqual(list(self.memory[CUP].errors()["time"]), [])


class Connected(Committing, ConnectedDoor, unittest.TestCase):
    def test_a_memory_of_a_server_has_no_files_here(self):
        self.commit(1)
        for call in (self.memory.models, lambda: self.memory[CUP].model,
                     self.memory[CUP].errors, self.memory[CUP].latents,
                     lambda: engram.check(self.memory)):
            with self.assertRaisesRegex(errors.FailedPreconditionError, "no files here"):
                call()
        self.assertIn(self.server.endpoint, repr(self.memory))
        self.assertIn("1 snapshots", repr(self.memory[CUP]))

    def test_it_is_pickled_by_its_endpoint_unless_there_is_a_secret(self):
        self.commit(1)
        with pickle.loads(pickle.dumps(self.memory)) as other:
            self.assertEqual(other.entities, [CUP])
        with engram.connect(self.server.endpoint, token="secret") as secret:
            with self.assertRaisesRegex(errors.FailedPreconditionError, "not pickled"):
                pickle.dumps(secret)

    def test_a_server_that_is_gone_is_unavailable(self):
        self.server.stop()
        with engram.connect(self.server.endpoint, timeout=0.3) as memory:
            for call in (lambda: memory.query("Objects"), lambda: memory.commit(CUP, 1),
                         lambda: memory.entities, memory.watch):
                with self.assertRaises(errors.UnavailableError):
                    call()

    def test_endpoints_and_options_are_checked(self):
        for arguments in (dict(endpoint=5), dict(endpoint="no endpoint"), dict(endpoint="a:b:c"),
                          dict(endpoint="unix:" + "x" * 300), dict(endpoint="h:4817", token=5),
                          dict(endpoint="h:4817", ca=5), dict(endpoint="head.local:99999"),
                          dict(endpoint="h:4817", timeout=0)):
            with self.subTest(**arguments), self.assertRaises(errors.EngramError) as raised:
                engram.connect(**arguments).close()
            self.assertIsInstance(raised.exception, errors.InvalidArgumentError)
        with self.assertRaisesRegex(errors.EngramError, "absent.pem"):
            engram.connect("head.local:4817", ca=self.folder / "absent.pem")
        with engram.connect("unix:/nowhere/at.all", timeout=0.2) as memory:
            with self.assertRaisesRegex(errors.UnavailableError, "/nowhere/at.all"):
                memory.query("Objects")


if __name__ == "__main__":
    unittest.main()
