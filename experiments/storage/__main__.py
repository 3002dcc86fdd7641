# SPDX-License-Identifier: Apache-2.0
"""What a second of recording takes, from the robot to the night, beside video codecs."""

from experiments.paper.single import run_single
from experiments.storage.measure import measure
from experiments.storage.show import show

run_single("storage", __doc__, measure, show)
