# SPDX-License-Identifier: Apache-2.0
"""The same questions through three doors: doors_test.py ENGRAM, the program that serves.

A server answers first, which holds half of what it knows in working memory; then the store that it
leaves, opened as a live memory; then the same store, opened to be read.
"""

import pathlib
import sys
import tempfile
import unittest

import numpy as np
from served import Server, outcome_of

import engram

ENGRAM = sys.argv.pop()
CAMERA = "Vision/RGB/head/cam"
JOINTS = "RobotState/Proprioception/robot/joints"
SPEECH = "Speech/Commands/human/text"
START = 1_600_000_000 * 10**9
STEP = 200_000_000
LEARNED, TODAY = 32, 8  # Snapshots in the store and its models; committed to the server.

SELECTORS = [
    "all", "latest", "latest:3", "latest:500", "0..4", "-3..-1", "last:1s", "latest#0", "latest#1",
    "+200ms", "+300ms", "latest:2, +200ms, 0..1", "+10s", "+61s", "2090-01-01 00:00:00",
    str(START), str(START + 1), f"nearest:{START + 5 * STEP + 1}", f"nearest:{START + 1}~1ns",
    f"before:{START + 3 * STEP}", f"after:{START + (LEARNED - 1) * STEP}", f"before:{START}",
    f"time:{START + 30 * STEP}..{START + 34 * STEP}", "sometimes", "latest:0", "last:-1s",
]
NAMES = [CAMERA, JOINTS, SPEECH, "Nothing/is/of/that", ".*", "Vision", "Robot.* ; Speech", "(", ""]


def likeness_of(found):
    """All but how many images were decoded for it: a server keeps what it computed."""
    return found.entity, found.space, found.compared, found.moments


#: Questions of the objects, each of a memory.
QUESTIONS = {
    "entities": lambda memory: memory.entities,
    "length": lambda memory: [len(memory), *map(len, memory)],
    "contains": lambda memory: [CAMERA in memory, "Vision" in memory, 5 in memory],
    "missing": lambda memory: memory["Nothing/is/of/that"],
    "no entity": lambda memory: memory["Vision/RGB"],
    "first and last": lambda memory: [(one.name, one.first, one.last) for one in memory],
    "times": lambda memory: [one.times().astype(int).tolist() for one in memory],
    "some times": lambda memory: memory[JOINTS].times(START + 1, START + 35 * STEP).tolist(),
    "no times": lambda memory: memory[JOINTS].times(START + 10**15).tolist(),
    "snapshots": lambda memory: [list(one) for one in memory],
    "some snapshots": lambda memory: list(memory[CAMERA].snapshots(START + 20 * STEP)),
    "at": lambda memory: memory[CAMERA].at(START + 33 * STEP),
    "at the future": lambda memory: memory[JOINTS].at(memory[JOINTS].last + STEP),
    "at nothing": lambda memory: memory[JOINTS].at(START + 1),
    "nearest": lambda memory: memory[JOINTS].nearest(START + STEP // 3),
    "latest": lambda memory: memory[CAMERA].latest(3),
    "ahead": lambda memory: [memory[name].ahead(0.4) for name in (CAMERA, JOINTS)],
    "not ahead": lambda memory: memory[JOINTS].ahead(0),
    "behind": lambda memory: memory[JOINTS].ahead(-0.2),
    "window": lambda memory: memory[CAMERA].window(memory[CAMERA].last, [-0.4, 0, 0.2]),
    "predict": lambda memory: memory[JOINTS].predict([0.4, 0.2, 1.0]),
    "predict by": lambda memory: memory[CAMERA].predict(0.2, engine="copy-last"),
    "predict by nobody": lambda memory: memory[JOINTS].predict(0.2, engine="crystal-ball"),
    "predict too far": lambda memory: memory[JOINTS].predict(3600),
    "predict back": lambda memory: memory[JOINTS].predict(-0.2),
    "predict from": lambda memory: memory[CAMERA].predict([0.2, 0.6], at=START + 20 * STEP),
    "predict from between": lambda memory: memory[JOINTS].predict(0.4, at=START + 20 * STEP + 1),
    "predict from today": lambda memory: memory[JOINTS].predict(0.4, at=START + 34 * STEP),
    "predict from by": lambda memory: memory[JOINTS].predict(0.4, START + 9 * STEP, "line"),
    "predict from the start": lambda memory: memory[JOINTS].predict(0.2, at=START),
    "predict from before": lambda memory: memory[JOINTS].predict(0.2, at=START - 1),
    "predict from after": lambda memory: memory[JOINTS].predict(0.2, at=START + 10**15),
    "predict from too far": lambda memory: memory[JOINTS].predict(61, at=START + 9 * STEP),
    "plan": lambda memory: memory[CAMERA].predict([0.2, 0.6], at=START + 20 * STEP, plan=JOINTS),
    "plan today": lambda memory: memory[CAMERA].predict(0.4, at=START + 33 * STEP, plan=JOINTS),
    "no plan yet": lambda memory: memory[CAMERA].predict(0.2, plan=JOINTS),
    "plan by": lambda memory: memory[CAMERA].predict(0.2, START + STEP, "copy-last", plan=JOINTS),
    "plan of another": lambda memory: memory[CAMERA].predict(0.2, START + 9 * STEP, plan=SPEECH),
    "plan of nothing": lambda memory: memory[CAMERA].predict(0.2, START, plan="Nothing/is/of/that"),
    "plan of no entity": lambda memory: memory[CAMERA].predict(0.2, START, plan="Vision"),
    "plan for nothing": lambda memory: memory[JOINTS].predict(0.2, START + 9 * STEP, plan=CAMERA),
    "engines": lambda memory: memory[JOINTS].engines(0.2),
    "engines of images": lambda memory: memory[CAMERA].engines(0.4),
    "engines then": lambda memory: memory[JOINTS].engines(0.2, at=START + 20 * STEP),
    "engines between": lambda memory: memory[CAMERA].engines(0.4, at=START + 20 * STEP + 1),
    "engines today": lambda memory: memory[JOINTS].engines(0.2, at=START + 34 * STEP),
    "engines before": lambda memory: memory[JOINTS].engines(0.2, at=START - 1),
    "engines of the start": lambda memory: memory[JOINTS].engines(0.2, at=START),
    "query by": lambda memory: memory.query(f"{JOINTS} @ +200ms", engine="copy-last"),
    "query by nobody": lambda memory: memory.query(f"{JOINTS} @ +200ms", engine="crystal-ball"),
    "similar": lambda memory: likeness_of(memory[CAMERA].similar()),
    "similar then": lambda memory: likeness_of(
        memory[CAMERA].similar(START + 20 * STEP, 3, apart=0, context=0)),
    "similar today": lambda memory: likeness_of(memory[CAMERA].similar(START + 35 * STEP, apart=0)),
    "similar to an image": lambda memory: likeness_of(
        memory[CAMERA].similar(update_of(CAMERA, 33).value["image"], 3)),
    "similar numbers": lambda memory: likeness_of(memory[JOINTS].similar(START + 30 * STEP, 4)),
    "similar beside": lambda memory: likeness_of(memory[CAMERA].similar(beside={JOINTS: 0.5})),
    "similar among": lambda memory: likeness_of(
        memory[CAMERA].similar(among=f"{CAMERA} @ 25..34", apart=0)),
    "similar to nothing": lambda memory: memory[CAMERA].similar(START + 1),
    "similar to a small image": lambda memory: memory[CAMERA].similar(
        np.zeros((16, 16, 3), np.uint8)),
    "similar texts": lambda memory: memory[SPEECH].similar(),
    "similar beside nothing": lambda memory: memory[CAMERA].similar(beside={CAMERA: -1.0}),
    "similar among nothing": lambda memory: memory[CAMERA].similar(among="Speech"),
    "frame": lambda memory: memory[JOINTS].frame().to_csv(),
}
for name in NAMES:
    for selector in SELECTORS:
        for text in (f"{name} @ {selector}", f"?ids {name} @ {selector}"):
            QUESTIONS[text] = lambda memory, text=text: memory.query(text)


def update_of(entity, i):
    angles = np.sin(np.arange(3) + 0.1 * i)
    image = np.zeros((40, 48, 3), np.uint8)
    image[:, :, 0] = 40 + np.arange(48)
    image[14:26, 2 * i % 36 : 2 * i % 36 + 12] = (230, 60, 40)
    value = {
        CAMERA: {"image": image, "joints": f"{JOINTS}/{np.datetime64(START + i * STEP, 'ns')}"},
        JOINTS: {"position": angles, "load": np.float32(0.5 + 0.1 * i), "is_moving": i % 2 == 0},
        SPEECH: {"text": f"Bring me the salt, {i}", "to": ["Ada", None], "turn": np.int32(i)},
    }[entity]
    return engram.Update(entity, value, START + i * STEP, confidence=0.5)


def make_store(path):
    with engram.record(path) as recorder:
        for i in range(LEARNED):
            recorder.commit_all([update_of(CAMERA, i), update_of(JOINTS, i)])
        recorder.commit_all([update_of(SPEECH, 3)])
    engram.consolidate(path, steps=40, psnr=26, representation="latents", width=16, threads=1,
                       min_snapshots=10)


def answers_of(memory):
    return {name: outcome_of(question, memory) for name, question in QUESTIONS.items()}


def answers_of_doors(store, folder, prefer, commits):
    """By door and question."""
    answers = {}
    server = Server(ENGRAM, folder, store, prefer + ("s" if prefer == "latent" else ""))
    try:
        # Training and models share two cores with the other tests: a first answer may take long.
        with engram.connect(server.endpoint, timeout=120) as memory:
            for update in commits:
                memory.commit_all([update])
            answers["server"] = answers_of(memory)
    finally:
        server.stop()
    with engram.open(store, prefer, read_only=False) as memory:
        answers["live"] = answers_of(memory)
    with engram.open(store, prefer) as memory:
        answers["store"] = answers_of(memory)
    return answers


class Doors(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as folder:
            store = pathlib.Path(folder) / "robot.engram"
            make_store(store)
            today = [update_of(entity, i) for i in range(LEARNED, LEARNED + TODAY)
                     for entity in (CAMERA, JOINTS)]
            cls.recorded = answers_of_doors(store, pathlib.Path(folder), "recorded", today)
            cls.latent = answers_of_doors(store, pathlib.Path(folder), "latent", [])

    def assert_same(self, answers, door):
        for question, expected in answers["store"].items():
            with self.subTest(question=question):
                self.assertEqual(answers[door][question], expected)

    def test_a_server_answers_as_its_store(self):
        self.assert_same(self.recorded, "server")

    def test_a_live_memory_answers_as_its_store(self):
        self.assert_same(self.recorded, "live")

    def test_a_server_that_prefers_latents_answers_as_its_store(self):
        self.assert_same(self.latent, "server")

    def test_a_live_memory_that_prefers_latents_answers_as_its_store(self):
        self.assert_same(self.latent, "live")

    def test_the_questions_are_about_everything(self):
        def sources(answers):
            return [one[2] for one in answers["store"][f"{CAMERA} @ latest:2, +200ms, 0..1"][CAMERA]]

        self.assertEqual(sources(self.recorded), ["recorded"] * 4 + ["predicted"])
        self.assertEqual(sources(self.latent),
                         ["reconstructed"] * 2 + ["recorded"] * 2 + ["predicted"])
        for answers in (self.recorded, self.latent):
            self.assertEqual([one[6] for one in answers["store"]["plan"]], [JOINTS, JOINTS])
            self.assertEqual([one[6] for one in answers["store"]["predict from"]], ["", ""])
            self.assertEqual([one[6] for one in answers["store"]["no plan yet"]], [""])
        errors = {one[0] for one in self.recorded["store"].values() if isinstance(one, tuple)
                  and len(one) == 2}
        self.assertEqual(errors, {"NotFoundError", "InvalidArgumentError", "FailedPreconditionError"})
        self.assertGreater(len(QUESTIONS), 400)


if __name__ == "__main__":
    unittest.main()
