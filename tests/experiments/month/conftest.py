# SPDX-License-Identifier: Apache-2.0
"""Experiments are a package of the sources' root."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3]))
