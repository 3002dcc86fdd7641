# SPDX-License-Identifier: Apache-2.0
"""Leave-one-recording-out: how well images, joints and poses of a recording that no model has seen
are given back and predicted."""

from experiments.loocv.measure import measure
from experiments.loocv.show import show
from experiments.paper.single import run_single

run_single("loocv", __doc__, measure, show)
