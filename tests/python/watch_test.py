# SPDX-License-Identifier: Apache-2.0
"""Watching a live memory, here and in a server: watch_test.py ENGRAM, the program that serves."""

import itertools
import os
import signal
import sys
import threading
import time
import unittest

import numpy as np
from live_doors import CUP, ENOUGH, START, ConnectedDoor, OpenedDoor
from served import Server

import engram
from engram import idf

ConnectedDoor.program = sys.argv.pop()


class Watching:
    """Of both."""

    def test_a_watch_is_told_of_what_it_asked_for(self):
        with self.memory.watch("Objects/.*", timeout=ENOUGH) as watch:
            self.memory.commit("Speech/Text/human/said", "Hi", START)
            for i in range(3):
                self.commit(i)
            told = list(itertools.islice(watch, 3))
        self.assertEqual([one.time for one in told], [START + i * 200_000_000 for i in range(3)])
        self.assertEqual({one.entity for one in told}, {CUP})
        self.assertTrue(all(one.has_data and one.lost == 0 for one in told))
        self.assertTrue(idf.equal(told[2].value, {"x": np.float64(0.2)}))
        self.assertEqual(told[0].snapshot.instances[0].confidence, 1.0)

    def test_a_watch_may_be_told_of_ids_alone(self):
        with self.memory.watch(data=False, timeout=ENOUGH) as watch:
            self.commit(1)
            event = next(watch)
            self.assertEqual((event.has_data, event.value, event.entity), (False, None, CUP))
        with self.memory.watch(["Objects", "Vision"], max_bytes=1000, timeout=ENOUGH) as watch:
            self.commit(2, image=np.zeros((40, 40, 3), np.uint8))
            self.commit(3)
            self.assertEqual([next(watch).has_data, next(watch).has_data], [False, True])

    def test_a_watch_ends_with_its_time_and_goes_on_after_a_break(self):
        with self.memory.watch(timeout=0.05) as watch:
            self.assertEqual(list(watch), [])
            self.assertIsNone(watch.next(0))
            for i in range(4):
                self.commit(i)
            for _ in watch:
                break
            rest = [watch.next(ENOUGH).time for _ in range(3)]
            self.assertEqual(rest, [START + i * 200_000_000 for i in range(1, 4)])
            self.assertFalse(watch.is_closed)
        self.assertTrue(watch.is_closed)
        self.commit(5)
        self.assertEqual(list(watch), [])
        watch.close()

    def test_a_slow_watch_says_what_it_missed(self):
        with self.memory.watch(queue=2) as watch:
            for i in range(20):
                self.commit(i)
            until = time.monotonic() + ENOUGH
            told, lost = [], 0
            while len(told) + lost < 20 and time.monotonic() < until:
                event = watch.next(1)
                if event is not None:
                    told.append(event.time)
                    lost += event.lost
        self.assertEqual(len(told) + lost, 20)
        self.assertEqual(told, sorted(told))
        self.assertEqual(told[-1], START + 19 * 200_000_000)
        self.assertEqual(watch.lost, lost)

    def watched_in_a_thread(self, watch):
        """A thread that iterates, and what it was told."""
        told = []
        thread = threading.Thread(target=lambda: told.extend(watch))
        thread.start()
        return thread, told

    def test_closing_from_another_thread_ends_a_watch(self):
        for end in (lambda watch: watch.close(), lambda _: self.memory.close()):
            watch = self.memory.watch()
            thread, told = self.watched_in_a_thread(watch)
            self.commit(1)
            time.sleep(0.05)
            end(watch)
            thread.join(ENOUGH)
            self.assertFalse(thread.is_alive())
            self.assertLessEqual(len(told), 1)

    def test_other_threads_run_while_one_waits(self):
        with self.memory.watch(timeout=0.3) as watch:
            thread, _ = self.watched_in_a_thread(watch)
            moments = 0
            while thread.is_alive():
                time.sleep(0.001)
                moments += 1
        self.assertGreater(moments, 20)

    def test_ctrl_c_ends_a_watch(self):
        with self.memory.watch() as watch:
            timer = threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT))
            timer.start()
            with self.assertRaises(KeyboardInterrupt):
                for _ in watch:
                    pass
            timer.join()
            self.commit(1)
            self.assertEqual(watch.next(ENOUGH).entity, CUP)


class Opened(Watching, OpenedDoor, unittest.TestCase):
    pass


class Connected(Watching, ConnectedDoor, unittest.TestCase):
    def test_programs_tell_each_other(self):
        with engram.connect(self.server.endpoint) as other, other.watch(timeout=ENOUGH) as watch:
            self.commit(1)
            event = next(watch)
            self.assertTrue(idf.equal(event.value, {"x": np.float64(0.1)}))
            self.assertEqual(other[CUP].last, event.time)

    def test_a_watch_outlives_its_server(self):
        with self.memory.watch() as watch:
            self.commit(1)
            self.assertEqual(watch.next(ENOUGH).interruption, "")
            self.server.stop()
            self.server = Server(self.program, self.folder, self.folder / "robot.engram")
            self.addCleanup(self.server.kill)
            event, i = None, 2
            until = time.monotonic() + ENOUGH
            while event is None and time.monotonic() < until:
                self.commit(i)
                i += 1
                event = watch.next(0.2)
            self.assertIsNotNone(event)
            self.assertNotEqual(event.interruption, "")
            self.assertEqual(watch.interruptions, 1)


if __name__ == "__main__":
    unittest.main()
