# SPDX-License-Identifier: Apache-2.0
"""Skills of Python programs: skills_test.py ENGRAM, the program that serves."""

import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import unittest

from served import Server

import engram

PROGRAM = sys.argv.pop()
CUP = "Objects/Things/kitchen/cup"


@engram.skill("name: wave\nparameters: {times: {type: int, default: 3, min: 1, max: 10}}")
def wave(run, times):
    for i in range(times):
        run.report({"angle": 0.5 * i}, [CUP])
    return f"waved {times} times"


@engram.skill("name: wait\nstops_within: 5s")
def wait(run):
    while not run.wait(1):
        pass
    return "at rest"


@engram.skill("name: break")
def broken():
    raise engram.SkillFailure("the hand is off")


@engram.skill("name: haste")
def haste(run):
    """Ends while a thread of it still reports, as callbacks of other libraries do."""
    ended = []

    def report():
        try:
            while True:
                run.report({"angle": 1.0})
        except engram.EngramError as error:
            ended.append(type(error).__name__)

    HASTE.append((threading.Thread(target=report), ended))
    HASTE[-1][0].start()
    return "gone"


HASTE = []


@engram.skill("name: count\nparameters: {to: {type: position}}")
def count(run, **given):
    return engram.SkillEnd("counted", result={"sum": float(sum(given["to"]))}, links=(CUP,))


class SkillsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path = pathlib.Path(folder.name)
        self.server = Server(PROGRAM, path, path / "robot.engram")
        self.addCleanup(self.server.kill)
        self.memory = engram.connect(self.server.endpoint)
        self.addCleanup(self.memory.close)

    def provider(self, *skills, name="arm"):
        provider = engram.SkillProvider(name, self.server.endpoint, timeout=2)
        self.addCleanup(provider.close)
        for one in skills:
            provider.add(one)
        return provider

    def test_a_function_is_a_skill(self):
        self.provider(wave, count)
        end = engram.run_skill(self.memory, "wave", {"times": 2})
        self.assertTrue(end, end)
        self.assertEqual(end.reason, "waved 2 times")
        reports = [
            one.value for one in self.memory.query("Skill/Event/arm/wave @ all")["Skill/Event/arm/wave"]
        ]
        self.assertEqual([one["stage"] for one in reports], [0, 1, 1, 2])
        self.assertEqual(reports[1]["results"], [CUP])
        self.assertTrue(all(one["request"] == end.request for one in reports))
        counted = engram.run_skill(self.memory, "arm/count", {"to": [1, 2, 3.5]})
        self.assertEqual((counted.outcome, counted.result), ("success", {"sum": 6.5}))

    def test_what_does_not_fit_is_refused_and_what_raises_fails(self):
        self.provider(wave, broken)
        refused = engram.run_skill(self.memory, "wave", {"times": 11, "tmies": 1})
        self.assertEqual(refused.outcome, "refused")
        self.assertIn("'times': found", refused.reason)
        self.assertIn("did you mean 'times'?", refused.reason)
        failed = engram.run_skill(self.memory, "break")
        self.assertFalse(failed)
        # It takes no run, which is its fault and no crash.
        self.assertIn("TypeError", failed.reason)

    def test_threads_that_report_to_the_end_hear_that_it_is_over(self):
        self.provider(haste)
        for _ in range(20):
            self.assertTrue(engram.run_skill(self.memory, "haste"))
            thread, ended = HASTE.pop()
            thread.join(20)
            self.assertEqual(ended, ["FailedPreconditionError"])

    def test_ctrl_c_stops_the_skill(self):
        self.provider(wait)
        timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.memory.watch("Skill/Event", timeout=10) as watch:
            with self.assertRaises(KeyboardInterrupt):
                engram.run_skill(self.memory, "wait")
            ends = [one.value for one in [next(watch), next(watch)]]
        self.assertEqual([one["outcome"] for one in ends], [0, 3])
        self.assertIn("at rest", ends[1]["reason"])

    def test_bad_providers_say_why(self):
        self.provider(wave)
        with self.assertRaisesRegex(engram.errors.AlreadyExistsError, "another provider"):
            self.provider()
        other = self.provider(name="leg")
        with self.assertRaisesRegex(engram.errors.InvalidArgumentError, "needs what @engram.skill"):
            other.add(print)
        with self.assertRaisesRegex(engram.errors.InvalidArgumentError, "speed"):
            other.add(engram.skill("name: x\nspeed: 1")(print))
        with self.assertRaises(engram.errors.NotFoundError):
            other.remove("x")

    def test_the_program_lists_and_runs_it(self):
        self.provider(wave)

        def said(*words):
            return subprocess.run(
                [PROGRAM, "skill", *words, "--server", self.server.endpoint],
                capture_output=True, text=True, timeout=60, check=False,
            )

        self.assertRegex(said("ls").stdout, r"arm/wave +ready")
        run = said("run", "wave", "times=1")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("waved 1 times", run.stdout)
        refused = said("run", "wave", "times=20")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("refused", refused.stdout)
        said("disable", "wave")
        self.assertIn("disabled", said("why", "wave").stdout)
        self.assertIn("did you mean", said("stop", "wav").stderr)


if __name__ == "__main__":
    unittest.main()
