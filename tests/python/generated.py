# SPDX-License-Identifier: Apache-2.0
"""Makes the modules of tests/golden/idf/kitchen.xml and imports them."""

import importlib
import subprocess
import sys
from pathlib import Path


def generate(program, golden, out):
    """The modules `kitchen` and `thing`, generated into `out` by generate_main."""
    files = [Path(golden) / "thing.xml", Path(golden) / "kitchen.xml"]
    subprocess.run([program, out, *files], check=True)
    sys.path.insert(0, str(out))
    return importlib.import_module("kitchen"), importlib.import_module("thing")
