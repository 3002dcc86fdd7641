# SPDX-License-Identifier: Apache-2.0
"""Looks at the results of all experiments: check_paper.py FOLDER."""

import json
import pathlib
import re
import sys

from experiments.loocv.show import worst_disagreement
from experiments.paper.recordings import CAMERA

MAX_DISAGREEMENT = 1e-6  # dB, or of SSIM.
# What networks draw depends on the order in which threads add: the night measured with one thread,
# the reader draws with all of them, and a value next to a half is then rounded to the other side.
# One of 200,000 values at 21 dB is 2e-6 dB.
MAX_ROUNDING_DB = 1e-4
FOLDER = pathlib.Path(sys.argv[1])


def need(is_so: bool, what: str) -> None:
    if not is_so:
        sys.exit(f"paper: {what}")


page = (FOLDER / "paper.html").read_text(encoding="utf-8")
need("not run" not in page, "something was not run")
need(page.count("<table>") >= 9, f"found {page.count('<table>')} tables, needs 9")
need(page.count("data:image/png") >= 5, "figures are missing")
need(not re.search(r'(src|href)="(?!#|data:)', page), "it needs other files")
found = {name: json.loads((FOLDER / f"{name}-result.json").read_text())["found"]
         for name in ("storage", "loocv", "transfer")}
for case in found["storage"]:
    images = case["stages"]["entities"][CAMERA]
    need(images["offered"] > images["kept"] > images["stored"] > 0,
         f"images of {case['dataset']}: {images} do not get smaller from stage to stage")
    need(any(case["latents"]), f"no latents of {case['dataset']}")
    for one in filter(None, case["latents"]):
        need(abs(one["psnr_db"] - one["program_psnr_db"]) < MAX_ROUNDING_DB,
             f"latents: found {one['program_psnr_db']} dB, scikit-image says {one['psnr_db']}")
worst = worst_disagreement(found["loocv"])
need(worst < MAX_DISAGREEMENT, f"scikit-image differs by {worst}")
need(all(step["median"] > 0 for row in found["transfer"]["steps"]
         for step in row["steps"].values()), "steps without a time")
print(f"{len(found['storage'])} stores, {len(found['loocv'])} cross-validations, "
      f"{len(found['transfer']['ages'])} ages; scikit-image differs by {worst:.1e}")
