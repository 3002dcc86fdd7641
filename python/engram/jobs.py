# SPDX-License-Identifier: Apache-2.0
"""What is done to a whole store: consolidate, forget, check, reflect, notice.

Each takes a path or an open Memory, which then sees what came of it, and gives the report that the
command of the same name prints with `--json`. Ctrl-C, or an exception of `progress`, stops it: all
are safe to stop at any moment.
"""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from typing import Any, Union

from engram import _core
from engram.errors import FailedPreconditionError, InvalidArgumentError
from engram.memory import Memory
from engram.progress import ProgressLike, sink_of
from engram.times import DurationLike, TimeLike, duration_ns, to_ns

StoreLike = Union[str, "os.PathLike[str]", Memory]
Report = dict[str, Any]


def consolidate(
    store: StoreLike,
    entities: str | Sequence[str] = (),
    *,
    training: DurationLike = 120,
    steps: int | None = None,
    budget: DurationLike | None = None,
    until: TimeLike | None = None,
    psnr: float | None = None,
    representation: str = "auto",
    number_bound: float | None = None,
    width: int = 0,
    nights: int | None = None,
    refine: int | None = None,
    access: DurationLike | None = None,
    video_effort: int | None = None,
    video_tolerance: float | None = None,
    augmented: str | os.PathLike[str] | None = None,
    seed: int = 1,
    threads: int = 2,
    min_snapshots: int | None = None,
    anew: bool = False,
    force: bool = False,
    reuse_models: bool = False,
    dry_run: bool = False,
    progress: ProgressLike = None,
) -> Report:
    """Trains an autoencoder per entity, stores latents and measures them, in this process.

    `entities`: names or patterns; none: all. `training`: seconds of training of all entities
    together; `steps` instead gives the same model for the same seed. `budget`: seconds for
    everything, measuring and encoding included, or `until`: the moment when all is over; what is
    not done by then waits for the next job. `psnr`: least PSNR of every image in dB, with `representation="latents"` the
    mean to aim at. The others: `engram consolidate --help`. The command is a little quicker: it
    may train two entities at once.

    `progress`: True for a bar, or a callable that takes a Progress.
    Raises NotFoundError, InvalidArgumentError, DataLossError, KeyboardInterrupt.
    """
    options = {
        "entities": [entities] if isinstance(entities, str) else list(entities),
        "training": duration_ns(training),
        "steps": steps,
        "budget": None if budget is None else duration_ns(budget),
        "until": None if until is None else to_ns(until),
        "psnr": None if psnr is None else float(psnr),
        "representation": representation,
        "number_bound": None if number_bound is None else float(number_bound),
        "width": width,
        "nights": nights,
        "refine": refine,
        "access": None if access is None else duration_ns(access),
        "video_effort": video_effort,
        "video_tolerance": None if video_tolerance is None else float(video_tolerance),
        "augmented": None if augmented is None else os.fspath(augmented),
        "seed": seed,
        "threads": threads,
        "min_snapshots": min_snapshots,
        "anew": anew,
        "force": force,
        "reuse_models": reuse_models,
        "dry_run": dry_run,
    }
    tell, finish = sink_of(progress)
    try:
        report = _core.consolidate(_path_of(store), options, tell)
    finally:
        finish()
    return _conclude(store, report)


def forget(
    store: StoreLike,
    names: str | Sequence[str] = (),
    *,
    config: str | os.PathLike[str] | None = None,
    dry_run: bool = True,
    erase: bool = False,
    progress: ProgressLike = None,
) -> Report:
    """Takes snapshots out of a store for good; with `dry_run`, the default, only says which.

    `names`: IDs of any level or queries with a selector. `config`: a YAML file with a section
    `forget` (docs/forgetting.md): its policies decide where no names are given, else its protection
    counts. Its steps of fading leave old images with less quality (`report["done"]["faded"]`).
    `erase`: nothing of it is left in any file, also of what was forgotten before
    (`report["done"]["erased"]`).
    """
    targets = [names] if isinstance(names, str) else list(names)
    if not targets and config is None and not erase:
        raise InvalidArgumentError("forget: found nothing to forget, needs names or a config")
    tell, finish = sink_of(progress)
    try:
        report = _core.forget(
            _path_of(store),
            targets,
            "" if config is None else os.fspath(config),
            dry_run,
            erase,
            tell,
        )
    finally:
        finish()
    return _conclude(store, report)


def check(store: StoreLike, *, deep: bool = False, progress: ProgressLike = None) -> Report:
    """Reads every byte and verifies every checksum; changes nothing.

    "clean" says whether all is well, "findings" what is not. `deep`: decodes every image, too.
    """
    tell, finish = sink_of(progress)
    try:
        return dict(json.loads(_core.check(_path_of(store), deep, tell)))
    finally:
        finish()


def reflect(
    store: StoreLike,
    query: str = "",
    *,
    against: str | os.PathLike[str] | None = None,
    images: bool = False,
    commit: bool = False,
    progress: ProgressLike = None,
) -> Report:
    """Looks for what is odd in a store: "findings"; and says what is usual: "entities", "skills",
    "chains" of failures.

    `query`: what is looked at, without `@` all snapshots of it. `against`: a store to compare
    with; adds "differences". `images`: do they stand still, too. `commit`: records what was found
    into the store, where it can be asked about: "Reflection @ latest".
    Raises NotFoundError, InvalidArgumentError, FailedPreconditionError, KeyboardInterrupt.
    """
    tell, finish = sink_of(progress)
    other = "" if against is None else os.fspath(against)
    try:
        report = _core.reflect(_path_of(store), query, other, images, commit, tell)
    finally:
        finish()
    return _conclude(store, report)


def notice(
    store: StoreLike,
    joints: str = "",
    *,
    opened: str = "auto",
    commit: bool = False,
    progress: ProgressLike = None,
) -> Report:
    """Finds what the robot took and let go in the joints of its hands, where nobody told of it.

    "deeds": each with "hand", "thing" and "place" as its episode's task names them, "took" and
    "let_go" (times), and "joints", the snapshots that show it. `joints`: their entity; else each
    below RobotState that has a hand. `opened`: whether the numbers of an open hand are "high" or
    "low". `commit`: writes them into the store, which can then be asked about them (`Memory.ask`).
    Raises NotFoundError where nothing has joints of hands, InvalidArgumentError,
    FailedPreconditionError where others told of all of them, KeyboardInterrupt.
    """
    tell, finish = sink_of(progress)
    try:
        report = _core.notice(_path_of(store), joints, opened, commit, tell)
    finally:
        finish()
    return _conclude(store, report)


def _path_of(store: StoreLike) -> str:
    if not isinstance(store, Memory):
        return os.fspath(store)
    if not store.path:
        raise FailedPreconditionError(f"{store!r}: has no files here, needs the path of its store")
    return store.path


def _conclude(store: StoreLike, report: str) -> Report:
    if isinstance(store, Memory):
        store.refresh()
    return dict(json.loads(report))
