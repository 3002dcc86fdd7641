# SPDX-License-Identifier: Apache-2.0
"""How well a day is predicted that no model has seen, as JSON. Usage: STORE RAW DAY

Every prediction is made as of a moment of the day, from what was stored until then. Its error is
measured against what the sensors gave, and its bound stands beside that of copying.
"""
from __future__ import annotations

import json
import pathlib
import sys
from typing import Any

import numpy as np

import engram
from experiments.month import days

STEPS_AHEAD = (1, 2, 3)
MAX_MOMENTS = 300


def error_of(entity: str, snapshot: Any, raw: days.RawDay, row: int) -> float:
    """The mean squared error of a prediction of moment `row`."""
    if entity == days.CAMERA:
        real, told = raw.images[row].astype(np.float64), snapshot.image
    else:
        real, told = raw.joints[row].astype(np.float64), snapshot.value["position"]
    return float(((real - told) ** 2).mean())


def bound_of(entity: str, snapshot: Any) -> float | None:
    """The bound of a prediction as a mean square."""
    bound = snapshot.instances[0].bound
    if bound is None:
        return None
    found: float | None = bound.image_mse if entity == days.CAMERA else bound.number_mse
    return found


def measure(entity: Any, raw: days.RawDay) -> dict[str, Any]:
    """Counts of one entity. Widths are sums of roots of bounds, over moments with both."""
    ahead = [step * days.STEP_NS / 1e9 for step in STEPS_AHEAD]
    # Of the first moment of a day nothing but the moment itself is known.
    moments = entity.times(int(raw.times[0]), int(raw.times[-1])).astype(np.int64)[1:]
    moments = moments[moments <= raw.times[-1] - max(STEPS_AHEAD) * days.STEP_NS]
    chosen = moments[:: max(1, -(-len(moments) // MAX_MOMENTS))]
    found: dict[str, Any] = {"predictions": 0, "bounds": 0, "within": 0, "compared": 0,
                             "width": 0.0, "copy_width": 0.0, "squared_error": 0.0,
                             "copy_squared_error": 0.0, "engines": {}, "by_step": {}}
    for moment in chosen:
        predicted = entity.predict(ahead, at=int(moment))
        copied = entity.predict(ahead, at=int(moment), engine="copy-last")
        for step, one, copy in zip(STEPS_AHEAD, predicted, copied, strict=True):
            row = raw.places[int(moment) + step * days.STEP_NS]
            error = error_of(entity.name, one, raw, row)
            bound, copy_bound = bound_of(entity.name, one), bound_of(entity.name, copy)
            found["predictions"] += 1
            found["squared_error"] += error
            found["copy_squared_error"] += error_of(entity.name, copy, raw, row)
            found["engines"][one.predictor] = found["engines"].get(one.predictor, 0) + 1
            of_step = found["by_step"].setdefault(str(step), {"bounds": 0, "within": 0})
            if bound is not None:
                for counts in (found, of_step):
                    counts["bounds"] += 1
                    counts["within"] += error <= bound
            if bound is not None and copy_bound is not None:
                found["compared"] += 1
                found["width"] += bound**0.5
                found["copy_width"] += copy_bound**0.5
    return found


def main() -> None:
    store, folder, day = sys.argv[1:]
    raw = days.RawDay.load(days.file_of(pathlib.Path(folder), int(day)))
    with engram.open(store) as memory:
        print(json.dumps({name: measure(memory[name], raw) for name in (days.CAMERA, days.JOINTS)}))


if __name__ == "__main__":
    main()
