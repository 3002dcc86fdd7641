# SPDX-License-Identifier: Apache-2.0
"""All experiments, and one report of them: WORK/PROFILE/paper.html.

Examples:
  make paper                       everything, on recordings
  make paper PAPER=short           in some minutes, on a short simulated kitchen
  python3 -m experiments.paper --minutes 0     the report of what was measured before
"""

import sys
from types import ModuleType

import experiments.loocv.measure
import experiments.loocv.show
import experiments.storage.measure
import experiments.storage.show
import experiments.transfer.measure
import experiments.transfer.show
from experiments.paper.measuring import arguments_of
from experiments.paper.report import write_page
from experiments.paper.single import facts, run_one

TITLE = "A deep episodic memory, measured"
LEAD = ("<p>What the paper “A Memory System of a Robot Cognitive Architecture and its "
        "Implementation in ArmarX” measured of its memory, measured of Engram, beside the paper's "
        "figures where they are known (shaded) and beside what one would use instead.</p>")


def main() -> int:
    options = arguments_of(__doc__, "paper")
    parts: list[tuple[str, ModuleType, ModuleType]] = [
        ("storage", experiments.storage.measure, experiments.storage.show),
        ("loocv", experiments.loocv.measure, experiments.loocv.show),
        ("transfer", experiments.transfer.measure, experiments.transfer.show)]
    runs = [run_one(name, options, measure.measure, show.show) for name, measure, show in parts]
    measurings = [measuring for measuring, _ in runs]
    page = measurings[0].folder / "paper.html"
    write_page(page, TITLE, LEAD + facts(measurings), [section for _, section in runs])
    print(page)
    missing = sum(len(one.skipped) for one in measurings)
    if missing:
        print(f"paper: {missing} measurements were not run: no time was left", file=sys.stderr)
    return 1 if missing else 0


sys.exit(main())
