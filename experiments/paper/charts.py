# SPDX-License-Identifier: Apache-2.0
"""How the plots look: one style, colours that the colour-blind tell apart, white background."""

from __future__ import annotations

import pathlib
from collections.abc import Callable, Sequence
from typing import Any

import matplotlib
import numpy as np
import numpy.typing as npt

matplotlib.use("agg")
import matplotlib.pyplot as plt  # noqa: E402

OURS = "#c1272d"
# Okabe and Ito's colours.
COLOURS = {"blue": "#0072b2", "orange": "#e69f00", "green": "#009e73", "sky": "#56b4e9",
           "purple": "#cc79a7", "grey": "#6e6e6e", "ours": OURS, "brown": "#8b5a2b"}

plt.rcParams.update({
    "figure.dpi": 110, "savefig.dpi": 110, "font.size": 9.5, "axes.spines.top": False,
    "axes.spines.right": False, "axes.grid": True, "grid.color": "#e4e7eb", "grid.linewidth": 0.7,
    "axes.axisbelow": True, "legend.frameon": False, "legend.fontsize": 8.5,
    "axes.titlesize": 10.5, "axes.titleweight": "bold", "figure.constrained_layout.use": True,
    "font.family": "DejaVu Sans"})


def panels(columns: int, rows: int = 1, width: float = 4.4, height: float = 3.6) -> tuple[Any, Any]:
    """A figure, and its axes [rows, columns]."""
    figure, axes = plt.subplots(rows, columns, figsize=(width * columns, height * rows),
                                squeeze=False)
    return figure, axes


def format_values(axis: Any, text: Callable[[float], str]) -> None:
    """Labels of an x or y axis."""
    axis.set_major_formatter(plt.FuncFormatter(lambda value, _: text(value)))


def save(figure: Any, file: pathlib.Path) -> pathlib.Path:
    figure.savefig(file, facecolor="white", bbox_inches="tight")
    plt.close(figure)
    return file


def image_grid(rows: Sequence[Sequence[npt.NDArray[np.uint8] | None]], titles: Sequence[str],
               labels: Sequence[str], below: Sequence[Sequence[str]], file: pathlib.Path,
               ) -> pathlib.Path:
    """Images beside each other, with a line of text below each."""
    figure, axes = plt.subplots(len(rows), len(titles), squeeze=False,
                                figsize=(1.75 * len(titles) + 0.4, 2.0 * len(rows) + 0.25))
    for y, row in enumerate(rows):
        for x, image in enumerate(row):
            axis = axes[y, x]
            axis.set_xticks([])
            axis.set_yticks([])
            axis.grid(False)
            for spine in axis.spines.values():
                spine.set_visible(False)
            if image is not None:
                axis.imshow(image, interpolation="nearest")
            if y == 0:
                axis.set_title(titles[x], fontsize=9)
            axis.set_xlabel(below[y][x], fontsize=8, labelpad=2)
        axes[y, 0].set_ylabel(labels[y], fontsize=9)
    return save(figure, file)
