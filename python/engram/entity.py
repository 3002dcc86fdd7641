# SPDX-License-Identifier: Apache-2.0
"""One thing over time, as a memory has it: `memory["Vision/RGB/head/cam"]`."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from engram.doors import Door
from engram.errors import InvalidArgumentError, NotFoundError
from engram.frame import frame_of
from engram.likeness import MomentMap, Similar, similar_of
from engram.saliency import Salient, salient_of
from engram.model import Latents, Model, latents_of
from engram.snapshot import Engine, Snapshot, engine_of, snapshot_of
from engram.times import DurationLike, TimeLike, duration_ns, to_datetime64, to_ns

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import]

_SNAPSHOTS_AT_ONCE = 16
_TIMES_AT_ONCE = 100_000


class Entity:
    """One thing over time: its past, and what is predicted of it.

    It asks the memory that gave it, as long as that is open, and sees what is committed meanwhile
    where the memory is live. Threading: as Memory.
    """

    def __init__(self, door: Door, name: str) -> None:
        self._door = door
        self.name = name

    def __len__(self) -> int:
        """Moments that are kept."""
        return int(self._door.summary(self.name)["snapshots"])

    @property
    def first(self) -> int:
        """Time of the first moment, in ns."""
        return self._door.span(self.name)[0]

    @property
    def last(self) -> int:
        """Time of the last moment, in ns."""
        return self._door.span(self.name)[1]

    def summary(self) -> dict[str, Any]:
        """What there is of it: "snapshots", "first", "last" (ns), "models" (versions), and bytes.

        "raw_bytes": plain; "stored_bytes": as recorded; "latent_bytes", "model_bytes": as learned.
        Of a live memory the first three alone.
        """
        return self._door.summary(self.name)

    def at(self, time: TimeLike) -> Snapshot:
        """The moment at exactly this time; behind the last one, a prediction.

        Raises NotFoundError where there is none.
        """
        return self._one(f"time:{to_ns(time)}")

    def nearest(self, time: TimeLike) -> Snapshot:
        """The moment that is closest in time, never a prediction."""
        return self._one(f"nearest:{to_ns(time)}")

    def latest(self, count: int = 1) -> list[Snapshot]:
        """The last `count` moments, oldest first."""
        return self._select(f"latest:{count}")

    def ahead(self, duration: DurationLike) -> Snapshot:
        """A prediction so long (seconds) behind the last moment."""
        offset = duration_ns(duration)
        # In one question: another moment may come between two.
        return self._one(f"+{offset}ns") if offset > 0 else self.at(self.last + offset)

    def predict(
        self,
        ahead: DurationLike | Sequence[DurationLike],
        at: TimeLike | None = None,
        engine: str = "",
        *,
        plan: str = "",
        start: TimeLike | None = None,
    ) -> list[Snapshot]:
        """What is expected so long (seconds) after the last moment up to `at` (None: the newest).

        Nothing after `at` is looked at: what really came can be compared. `engine`: one of
        engines(); empty: those that were best on the past, for each horizon and member. `plan`: the
        entity whose moments after `at` tell where what a model is conditioned on is going to be
        (planned joints, for a camera); then the model alone predicts. Where nothing is planned, the
        prediction is made without it, and its `plan` is empty. `start`: `at` in programs of earlier
        versions; it is taken until 0.3.
        Raises NotFoundError where there is no moment up to `at`, engine or plan of that name,
        InvalidArgumentError where a horizon is too far ahead or nothing can be told the plan,
        FailedPreconditionError where a server is of a version that predicts from now alone.
        """
        horizons = [ahead] if isinstance(ahead, (int, float, np.timedelta64)) else ahead
        if not isinstance(horizons, Sequence):
            horizons = [horizons]
        wanted = [duration_ns(one) for one in horizons]
        for one in wanted:
            if one <= 0:
                raise InvalidArgumentError(
                    f"entity '{self.name}': found a horizon of {one} ns, needs more than zero"
                )
        if not wanted:
            return []
        found = self._door.predict(self.name, wanted, _last_known(at, start), engine, plan)
        return [snapshot_of(one) for one in found]

    def engines(
        self, ahead: DurationLike, at: TimeLike | None = None, *, start: TimeLike | None = None
    ) -> list[Engine]:
        """All ways to predict so long (seconds) ahead, the best on the past of the entity first.

        `at`: as of this moment; nothing after it is looked at. Raises NotFoundError where there is
        no moment up to it, FailedPreconditionError where a server is of a version that lists those
        of now alone.
        """
        found = self._door.engines(self.name, duration_ns(ahead), _last_known(at, start))
        return [engine_of(one) for one in found]

    def similar(
        self,
        to: TimeLike | npt.NDArray[Any] | None = None,
        count: int = 10,
        *,
        apart: DurationLike = 1.0,
        context: DurationLike = 2.0,
        one_per_recording: bool = False,
        elsewhere: bool = False,
        among: str = "",
        beside: Mapping[str, float] | None = None,
        any_size: bool = False,
    ) -> Similar:
        """The moments that are most like one of this entity, or like an image; nearest first.

        `to`: a moment, an image (H, W, C), or None for the last moment. `apart` (seconds): a moment
        so near to a more alike one, or to `to`, is left out. `context` (seconds): how far back what
        came before is compared, too; 0: only the moment itself. `one_per_recording`: the nearest
        moment of each recording. `elsewhere`: none of the recording of `to`. `among`: a query that
        selects the moments (docs/query.md). `beside`: other entities that must be alike, too, with
        their weights beside 1. `any_size`: take an image of another size. A live memory compares
        what its working memory holds, too.
        Raises NotFoundError where there is no such moment, InvalidArgumentError where an image has
        another size, FailedPreconditionError where there are neither images nor numbers, or where
        a server may show its images redacted only. Source: docs/recall.md.
        """
        image = to if isinstance(to, np.ndarray) else None
        moment = None if isinstance(to, np.ndarray) else self.last if to is None else to_ns(to)
        found = self._door.similar(
            self.name,
            moment,
            image,
            among,
            count,
            duration_ns(apart),
            duration_ns(context),
            one_per_recording,
            elsewhere,
            any_size,
            dict(beside or {}),
        )
        return similar_of(self.name, found)

    def map(self, max_moments: int = 2000) -> MomentMap:
        """Moments in two dimensions, evenly spread, those that are like each other near.

        Draw it with `plt.scatter(map.x, map.y, c=map.times)`. Raises InvalidArgumentError unless
        there may be a moment, FailedPreconditionError where there are neither images nor numbers,
        and of a memory in a server. Source: docs/recall.md.
        """
        if max_moments < 1:
            raise InvalidArgumentError(f"max_moments {max_moments}: needs at least 1")
        return MomentMap(self.name, **self._door.map(self.name, max_moments))

    def why_salient(self, time: TimeLike | None = None) -> Salient:
        """What the snapshot at `time` (None: the last one) is worth, and why.

        What is explained is in files: of a live memory, what has left its working memory.
        Raises NotFoundError where there is no such snapshot, FailedPreconditionError where it is
        damaged, and of a memory in a server. Source: docs/saliency.md.
        """
        moment = None if time is None else to_ns(time)
        return salient_of(self.name, self._door.files().why_salient(self.name, moment))

    def window(self, time: TimeLike, offsets: Sequence[DurationLike]) -> list[Snapshot]:
        """What was closest to each of `time` + offset (seconds); predictions of the future."""
        times = [to_ns(time) + duration_ns(offset) for offset in offsets]
        last = self.last
        return [self.at(one) if one > last else self.nearest(one) for one in times]

    def snapshots(
        self,
        start: TimeLike | None = None,
        end: TimeLike | None = None,
        *,
        where: str = "",
    ) -> Iterator[Snapshot]:
        """The moments from `start` to `end`, both included, in order; a few are in memory.

        `where` has conditions on their place and context (docs/query.md, "Conditions"):
        "within Objects/Surfaces/kitchen/table 0.3m while Skill/Event/robot/pick". Raises
        ValueError for what is no condition, and EngramError for a place that is not there.
        """
        if where:
            met = self._meeting(start, end, where)
            for i in range(0, len(met), _SNAPSHOTS_AT_ONCE):
                some = met[i : i + _SNAPSHOTS_AT_ONCE]
                yield from self._select(", ".join(f"time:{time}" for time in some))
            return
        after = None if start is None else to_ns(start) - 1
        stop = None if end is None else to_ns(end)
        while True:
            found = self._door.times(self.name, after, _SNAPSHOTS_AT_ONCE)
            wanted = [time for time in found if stop is None or time <= stop]
            # A live memory tells all of them at once.
            for i in range(0, len(wanted), _SNAPSHOTS_AT_ONCE):
                some = wanted[i : i + _SNAPSHOTS_AT_ONCE]
                yield from self._select(f"time:{some[0]}..{some[-1]}")
            if len(wanted) != _SNAPSHOTS_AT_ONCE:
                return
            after = wanted[-1]

    def __iter__(self) -> Iterator[Snapshot]:
        return self.snapshots()

    def times(
        self,
        start: TimeLike | None = None,
        end: TimeLike | None = None,
        *,
        where: str = "",
    ) -> npt.NDArray[np.datetime64]:
        """The moments from `start` to `end`, both included, as datetime64[ns]; decodes nothing.

        `where` is that of `snapshots`.
        """
        if where:
            met = self._meeting(start, end, where)
            return np.asarray(met, np.int64).astype("datetime64[ns]")
        after = None if start is None else to_ns(start) - 1
        stop = None if end is None else to_ns(end)
        times: list[int] = []
        while True:
            found = self._door.times(self.name, after, _TIMES_AT_ONCE)
            times += [time for time in found if stop is None or time <= stop]
            if len(found) != _TIMES_AT_ONCE or (stop is not None and found[-1] > stop):
                return np.asarray(times, np.int64).astype("datetime64[ns]")
            after = found[-1]

    def frame(self, start: TimeLike | None = None, end: TimeLike | None = None) -> pd.DataFrame:
        """The numbers, bools and texts from `start` to `end` as a DataFrame (needs pandas).

        A row per moment, indexed by time (UTC); arrays of up to 1,024 numbers are columns by place:
        "position/0".
        """
        return frame_of(self.snapshots(start, end))

    def errors(self) -> dict[str, npt.NDArray[Any]]:
        """How each moment that has latents is kept, as columns, decoding nothing.

        "time", "model" (version), "form" of its images ("latents", "refined", "residual", "video",
        "lossless", "gist"), "bytes", "psnr_db" and "rmse" as they were measured when it was made.
        `pandas.DataFrame(entity.errors())` takes it.
        """
        columns = self._door.files().stored_snapshots(self.name)
        columns["time"] = columns["time"].astype("datetime64[ns]")
        columns["form"] = np.asarray(columns["form"], dtype=str)
        return columns

    @property
    def model(self) -> Model:
        """The newest model. Raises NotFoundError where there is none."""
        found = [one for one in self._door.files().models() if one["entity"] == self.name]
        if not found:
            raise NotFoundError(f"'{self.name}': has no model, needs engram.consolidate first")
        return Model(**max(found, key=lambda one: int(one["version"])))

    def latents(self, start: TimeLike | None = None, end: TimeLike | None = None) -> Latents:
        """What the newest model keeps from `start` to `end`, as arrays: images are not decoded."""
        model = self.model
        first = -(2**63) if start is None else to_ns(start)
        last = 2**63 - 1 if end is None else to_ns(end)
        store = self._door.files()
        return latents_of(store.latents(self.name, model.version, first, last, model._open))

    def __repr__(self) -> str:
        about = self.summary()
        sizes = ""
        if "stored_bytes" in about:
            sizes = f", {_bytes(about['stored_bytes'] + about['latent_bytes'])}"
        models = f", model v{about['models'][-1]}" if about.get("models") else ""
        return (
            f"<Entity {self.name}: {about['snapshots']:,} snapshots, "
            f"{to_datetime64(about['first'])} to {to_datetime64(about['last'])}{sizes}{models}>"
        )

    def _meeting(self, start: TimeLike | None, end: TimeLike | None, where: str) -> list[int]:
        first = -(2**62) if start is None else to_ns(start)
        last = 2**63 - 1 if end is None else to_ns(end)
        return self._door.selected_times(self.name, f"time:{first}..{last} {where}")

    def _select(self, selector: str) -> list[Snapshot]:
        found = self._door.select(self.name, selector)
        return [snapshot_of(one) for one in found]

    def _one(self, selector: str) -> Snapshot:
        found = self._select(selector)
        if not found:
            raise NotFoundError(f"'{self.name}': has no moment '{selector}'")
        return found[0]


def _bytes(count: int) -> str:
    size = float(count)
    for unit in ("B", "kB", "MB", "GB"):
        if size < 1000:
            return f"{size:.3g} {unit}"
        size /= 1000
    return f"{size:.3g} TB"


def _last_known(at: TimeLike | None, start: TimeLike | None) -> int | None:
    if start is not None:
        warnings.warn("'start' is 'at' now, and is taken until 0.3", DeprecationWarning, 3)
        at = start
    return None if at is None else to_ns(at)
