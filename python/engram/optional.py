# SPDX-License-Identifier: Apache-2.0
"""Packages that only some of engram needs."""

from __future__ import annotations

import importlib
from types import ModuleType

_DEBIAN = {
    "matplotlib": "python3-matplotlib",
    "pandas": "python3-pandas",
    "roslib.message": "python3-roslib",
    "torch": "python3-torch",
}
# Packages of ROS are not on the index that pip asks.
_DEBIAN_ALONE = ("actionlib", "genpy", "rosgraph", "roslib.message", "rospy")


class MissingPackageError(ImportError):
    """A package is not installed; the message names the line that installs it."""


def needs(package: str, what: str) -> ModuleType:
    """The module. Raises MissingPackageError naming `what` needs it and how to install it."""
    try:
        return importlib.import_module(package)
    except ImportError as error:
        debian = _DEBIAN.get(package, f"python3-{package}")
        other = "" if package in _DEBIAN_ALONE else f"  (or: pip install {package})"
        raise MissingPackageError(
            f"{what} needs {package}: sudo apt-get install {debian}{other}"
        ) from error
