# SPDX-License-Identifier: Apache-2.0
"""Questions in English, from Python."""

import pathlib
import tempfile
import unittest

import engram
from engram.errors import InvalidArgumentError, NotFoundError

START = 1_767_254_400 * 10**9  # 2026-01-01 08:00:00.
PICK = "Skill/Event/robot/pick"


def second(seconds: float) -> int:
    return START + int(seconds * 10**9)


def event(outcome: int, started: float, ended: float | None) -> dict:
    value = {"skill": "robot/pick", "stage": 0 if ended is None else 2, "outcome": outcome}
    value |= {"reason": "", "started": second(started), "parameters": "{}", "hand": "left"}
    return value if ended is None else value | {"ended": second(ended)}


class SpeechTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name) / "store.engram"
        with engram.record(cls.path) as recorder:
            recorder.commit(PICK, event(0, 1, None), second(1))
            recorder.commit(PICK, event(2, 1, 3), second(3))

    @classmethod
    def tearDownClass(cls) -> None:
        cls.folder.cleanup()

    def test_answers_with_evidence(self) -> None:
        with engram.open(self.path) as memory:
            answer = memory.ask("Which hand did you use to grasp it?")
            self.assertEqual((answer.kind, answer.value), ("names", ["left"]))
            self.assertEqual(answer.route, "program")
            self.assertEqual(answer.evidence[0].id, PICK + "/2026-01-01 08:00:01.000000/0")
            self.assertEqual(str(answer), answer.text)
            self.assertEqual(memory.ask("How often did you fail?").value, 1)
            program = "executions outcome=failure | span"
            begin, end = memory.ask(program, is_program=True).value
            self.assertEqual((begin[-9:], end[-9:]), ("01.000000", "03.000000"))

    def test_does_not_know_what_is_not_there(self) -> None:
        with engram.open(self.path) as memory:
            answer = memory.ask("Where is the elephant?")
            self.assertEqual((answer.kind, answer.value, answer.evidence), ("unknown", None, []))
            self.assertIn("elephant", answer.looked_for)
            yesterday = "What did you do yesterday?"
            self.assertEqual(memory.ask(yesterday).kind, "unknown")
            self.assertEqual(memory.ask(yesterday, now="2026-01-02T12:00").kind, "events")
            with self.assertRaises(InvalidArgumentError):
                memory.ask("executions | guess", is_program=True)

    def test_tells_a_time(self) -> None:
        with engram.open(self.path) as memory:
            told = memory.tell()
            self.assertEqual([one.level for one in told], ["whole", "plan", "failure"])
            self.assertTrue(all(one.links for one in told))
            self.assertEqual(memory.tell("yesterday", "yesterday"), [])
            self.assertEqual(len(memory.tell(sentences=1)), 1)

    def test_knows_what_a_live_memory_was_told_since(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            with engram.open(pathlib.Path(folder) / "live", read_only=False) as memory:
                memory.commit(PICK, event(0, 1, None), second(1))
                now = second(60)
                self.assertEqual(memory.ask("How often did you pick up anything?", now=now).value, 1)
                memory.commit(PICK, event(1, 1, 3), second(3))
                memory.commit(PICK, event(0, 5, None), second(5))
                self.assertEqual(memory.ask("How often did you pick up anything?", now=now).value, 2)


class NoticeTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name) / "store.engram"
        with engram.record(self.path) as recorder:
            for i in range(100):  # It closes at 3 s, and opens at 6 s.
                opening = 0.8 if i < 30 or i > 60 else 0.4
                recorder.commit("RobotState/Joints/robot/arm", {"left_gripper": opening},
                                second(i / 10))

    def test_finds_what_nobody_told(self) -> None:
        report = engram.notice(self.path)
        (deed,) = report["deeds"]
        self.assertEqual((deed["hand"], deed["thing"], report["committed"]), ("left", "", 0))
        self.assertEqual(len(deed["joints"]), 4)
        with self.assertRaises(InvalidArgumentError):
            engram.notice(self.path, opened="wide")
        with self.assertRaises(NotFoundError):
            engram.notice(self.path, "RobotState/Joints/robot/leg")

    def test_lets_the_store_be_asked(self) -> None:
        asked = "Which hand did you use to pick something up?"
        with engram.open(self.path) as memory:
            self.assertEqual(memory.ask(asked).kind, "unknown")
            self.assertEqual(engram.notice(memory, commit=True)["committed"], 1)
            self.assertEqual(memory.ask(asked).value, ["left"])


if __name__ == "__main__":
    unittest.main()
