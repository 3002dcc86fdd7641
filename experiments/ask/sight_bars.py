#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What images show: how rightly is told what is where, and in which colour, from latents alone?

Kitchens whose things have colours are simulated, and a night turns their images into latents. A
network learns from them to see things (`engram learn-sights`). Other kitchens, of seeds that nothing
was trained on, get latents of the same model; of each all poses and states of things are forgotten,
and what `engram notice-sights` finds in the latents is asked about. Truth is what the same questions
are answered with where poses are known. The blind baseline is the commonest answer to each question
in the other kitchens that are asked, of all things or of the same thing, whichever is right more
often.
"""
from __future__ import annotations

import argparse
import collections
import datetime
import json
import pathlib
import shutil
import subprocess
import sys

from ask_bars import seeds_of

EXAMPLES = """Examples:
  sight_bars.py build/release/bin/engram
  sight_bars.py ENGRAM --train 7001..7004 --test 8001 --training 1m --budget 1m

What was made is kept in the folder of --work and used again."""

#: Images are thinned, so that nights are short.
THIN = """entities:
  - match: Vision/RGB/.*
    filters: [{frequency: {rate: 2.5Hz}}]
  - match: RobotState/Proprioception/.*
    filters: [{frequency: {rate: 5Hz}}]
  - match: RobotState/Localization/.*
    filters: [{frequency: {rate: 5Hz}}]
"""
CAMERA = "Vision/RGB/head/stereo"
#: Kitchens follow each other by an hour, and none lies in the future.
START = datetime.datetime(2025, 12, 3, 4)
#: Questions of a thing, with their kinds; each is asked at the same moments.
QUESTIONS = {"colour": ["What colour is the {thing}?"],
             "where": ["Where did you last see the {thing}?"],
             "on": ["Was the {thing} on the table?", "Was the {thing} on the counter?"]}
MOMENTS_S = [15, 30, 45, 59]


def run(*words):
    done = subprocess.run([str(word) for word in words], check=False, text=True,
                          capture_output=True)
    if done.returncode not in (0, 3):
        sys.exit(f"{' '.join(map(str, words))}: {done.stderr[-2000:]}")
    return done.stdout


def once(mark, work):
    """Does some work that leaves a mark, and not again."""
    if not mark.exists():
        work()
        mark.touch()


def begin_of(seed):
    return START + datetime.timedelta(hours=seed - 1)


def now_of(seed, seconds):
    return f"{begin_of(seed) + datetime.timedelta(seconds=seconds):%Y-%m-%d %H:%M:%S}Z"


def simulate(arguments, store, seed, *more):
    run(arguments.engram, "simulate", "kitchen", store, "--seed", seed, "--start",
        now_of(seed, 0).replace(" ", "T"), "--colours", "--seconds", arguments.seconds,
        "--progress", "none", *more)


def night(arguments, store, *more):
    run(arguments.engram, "consolidate", store, "--entity", CAMERA, "--representation", "latents",
        "--psnr", 36, "--width", 64, "--threads", arguments.threads, "--jobs", 1, "--progress",
        "none", *more)


def images_of(arguments):
    thin = arguments.work / "thin.yaml"
    thin.write_text(THIN)
    return ["--fast", "--config", thin]


def learn(arguments):
    """A store of the kitchens of training with a night, and what sees things in its latents."""
    store = arguments.work / "train.engram"
    for seed in arguments.train:
        once(arguments.work / f"train-{seed}.done",
             lambda seed=seed: simulate(arguments, store, seed, *images_of(arguments)))
    once(arguments.work / "night.done",
         lambda: night(arguments, store, "--training", arguments.training))
    network = arguments.work / "kitchens.sights"
    once(arguments.work / "sights.done",
         lambda: (arguments.work / "sights.json").write_text(
             run(arguments.engram, "learn-sights", store, "--out", network, "--budget",
                 arguments.budget, "--threads", arguments.threads, "--json")))
    return store, network


def base_of(arguments, trained):
    """The store of training without anything but its images of the last kitchen, so that it keeps
    their model."""
    base = arguments.work / "base.engram"
    camera = "/".join(CAMERA.split("/")[:2])

    def make():
        shutil.rmtree(base, ignore_errors=True)
        shutil.copytree(trained, base)
        names = json.loads(run(arguments.engram, "query", base, "?ids .* @ latest", "--json"))["ids"]
        others = {"/".join(name.split("/")[:2]) for name in names} - {camera}
        before = now_of(arguments.train[-1], -60).replace(" ", "T")
        run(arguments.engram, "forget", base, "--yes", f"{camera} @ until:{before}",
            *sorted(others))

    once(arguments.work / "base.done", make)
    return base


def remembered(arguments, base, network, seed):
    """A memory of one kitchen without states of things, and what was noticed in its images."""
    store = arguments.work / f"test-{seed}.engram"

    def make():
        shutil.rmtree(store, ignore_errors=True)
        shutil.copytree(base, store)
        simulate(arguments, store, seed, *images_of(arguments))
        run(arguments.engram, "forget", store, "Objects/Instances", "--yes")
        night(arguments, store, "--reuse-models")

    once(arguments.work / f"test-{seed}.done", make)
    run(arguments.engram, "notice-sights", store, "--network", network, "--since",
        now_of(seed, 0), "--commit")
    return store


def truth_of(arguments, seed):
    """The same kitchen with poses, without images: it is the same, bit for bit."""
    store = arguments.work / f"truth-{seed}.engram"

    def make():
        shutil.rmtree(store, ignore_errors=True)
        simulate(arguments, store, seed, "--fast", "--no-images")

    once(arguments.work / f"truth-{seed}.done", make)
    return store


def names_of_kinds(arguments, store):
    """What people call each kind of thing."""
    answer = json.loads(run(arguments.engram, "query", store, "Objects/Classes @ latest", "--json"))
    return {entity["id"].split("/")[-1]: entity["snapshots"][0]["instances"][0]["data"]["spoken_name"]
            for entity in answer["entities"]}


def asked_of(arguments, kinds, seed):
    return [{"kind": kind, "form": form, "question": template.format(thing=kinds[kind]),
             "template": template, "now": now_of(seed, moment)}
            for kind in kinds for moment in MOMENTS_S if moment < arguments.seconds
            for form, templates in QUESTIONS.items() for template in templates]


def ask(arguments, store, asked):
    file = arguments.work / "questions.jsonl"
    file.write_text("".join(json.dumps({"question": one["question"], "now": one["now"]}) + "\n"
                            for one in asked))
    lines = run(arguments.engram, "ask", store, "--questions", file, "--json", "--route",
                "program").splitlines()
    return [json.loads(line)["value"] for line in lines if line.strip()]


def is_known(value):
    return value["kind"] != "unknown"


def truths_of(arguments, seed):
    """What is asked of a kitchen, with true answers: rows without what was found."""
    truth = truth_of(arguments, seed)
    kinds = names_of_kinds(arguments, truth)
    asked = asked_of(arguments, kinds, seed)
    rows = [{"seed": seed, **one, "wanted": value}
            for one, value in zip(asked, ask(arguments, truth, asked)) if is_known(value)]
    # Of a thing that no image has shown so far no image can tell.
    shown = {(row["kind"], row["now"]) for row in rows if row["form"] == "where"}
    rows = [row for row in rows if (row["kind"], row["now"]) in shown]
    # A thing that says its colour in its name needs no image.
    return [row for row in rows
            if row["form"] != "colour" or not row["kind"].startswith(row["wanted"]["value"][0])]


def find(arguments, base, network, seed, rows):
    """Adds to the rows of a kitchen what its memory without poses answers."""
    store = remembered(arguments, base, network, seed)
    for row, value in zip(rows, ask(arguments, store, rows)):
        row["found"] = value
        row["right"] = value == row["wanted"]


def add_blind(rows):
    """Whether the commonest answers to the same question in the other kitchens are right."""
    for row in rows:
        others = [one for one in rows
                  if one["seed"] != row["seed"] and one["template"] == row["template"]]
        for name, of in (("blind_of_all", others),
                         ("blind_of_thing", [one for one in others if one["kind"] == row["kind"]])):
            counts = collections.Counter(json.dumps(one["wanted"], sort_keys=True) for one in of)
            wanted = json.dumps(row["wanted"], sort_keys=True)
            row[name] = bool(counts) and max(counts, key=counts.get) == wanted


def share(rows, name):
    return 100 * sum(row[name] for row in rows) / max(1, len(rows))


def main():
    parser = argparse.ArgumentParser(description=__doc__, epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engram", help="the program")
    parser.add_argument("--train", type=seeds_of, default="7001..7040", help="kitchens to learn from")
    parser.add_argument("--test", type=seeds_of, default="8001..8010", help="kitchens that are asked")
    parser.add_argument("--seconds", type=int, default=60, help="length of each")
    parser.add_argument("--training", default="20m", help="of the model of images")
    parser.add_argument("--budget", default="15m", help="of what sees things in latents")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("build/sights"))
    parser.add_argument("--bar", type=float, default=60, help="share that has to be right, in per cent")
    parser.add_argument("--json", type=pathlib.Path)
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)

    trained, network = learn(arguments)
    base = base_of(arguments, trained)
    rows = []
    for seed in arguments.test:
        of_seed = truths_of(arguments, seed)
        find(arguments, base, network, seed, of_seed)
        rows += of_seed
    add_blind(rows)
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=1))
    print(f"{len(arguments.test)} kitchens that nothing was trained on, of {len(arguments.train)} "
          "that were")
    print((arguments.work / "sights.json").read_text().strip())
    names = {"colour": "which colour", "where": "where last seen", "on": "was it on a place"}
    is_met = True
    for form, name in names.items():
        of = [row for row in rows if row["form"] == form]
        right = share(of, "right")
        alone = max(share(of, "blind_of_all"), share(of, "blind_of_thing"))
        is_met = is_met and right >= arguments.bar
        print(f"{name:20} right {right:5.1f} %   blind {alone:5.1f} %   of {len(of):5}   "
              f"bar {arguments.bar:g} %")
    return 0 if is_met else 1


if __name__ == "__main__":
    sys.exit(main())
