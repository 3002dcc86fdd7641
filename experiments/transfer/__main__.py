# SPDX-License-Identifier: Apache-2.0
"""What the working memory takes for an object: each step, and how much older data get on their way
through it than by a direct or a publish/subscribe connection."""

from experiments.paper.single import run_single
from experiments.transfer.measure import measure
from experiments.transfer.show import show

run_single("transfer", __doc__, measure, show)
