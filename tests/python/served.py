# SPDX-License-Identifier: Apache-2.0
"""A server in a process of its own, and what an answer says, for tests of several doors."""

import dataclasses
import json
import re
import signal
import subprocess

from engram import errors, idf


class Server:
    """`engram serve` on a Unix socket in `folder`; ended by its process ID."""

    def __init__(self, program, folder, store=None, prefer="recorded"):
        self.endpoint = f"unix:{folder}/s"
        server = {"name": "robot", "listen": self.endpoint}
        if store is not None:
            server |= {"store": str(store), "prefer": prefer}
        config = folder / "robot.yaml"
        config.write_text(json.dumps({"servers": [server], "system_state": False}))
        self._process = subprocess.Popen(
            [program, "serve", "--config", config, "--json"], stdout=subprocess.PIPE,
            stderr=subprocess.PIPE, text=True)
        if not self._process.stdout.readline():
            raise RuntimeError(self._process.communicate()[1])

    def stop(self):
        """As an administrator would: what it holds goes to its store."""
        self._end(signal.SIGTERM)
        if self._process.returncode != 0:
            raise RuntimeError(f"the server ended with {self._process.returncode}: {self.messages}")

    def kill(self):
        self._end(signal.SIGKILL)

    def _end(self, how):
        if self._process.poll() is None:
            self._process.send_signal(how)
            self.messages = self._process.communicate(timeout=60)[1]


def said_by(snapshot):
    """Everything that a snapshot says, to be compared; values bit by bit."""
    instances = [
        (*(getattr(one, field.name) for field in dataclasses.fields(one) if field.name != "value"),
         idf.encode(one.value))
        for one in snapshot.instances
    ]
    return (snapshot.entity, snapshot.time, snapshot.source, snapshot.model, snapshot.predictor,
            snapshot.horizon, snapshot.plan, instances)


def outcome_of(question, memory):
    """What `question` gives of a memory: everything that it says, or its error. Errors name the
    place that was asked, and behind a wire first the endpoint; these alone may differ."""
    try:
        return _said(question(memory))
    except errors.EngramError as error:
        text = str(error).removeprefix(f"{memory.endpoint}: ")
        return type(error).__name__, re.sub(r"(store|server|memory) '[^']*'", "PLACE", text)


def _said(found):
    if isinstance(found, dict):
        return {name: _said(one) for name, one in found.items()}
    if isinstance(found, (list, tuple)):
        return [_said(one) for one in found]
    if hasattr(found, "instances"):
        return said_by(found)
    return found if isinstance(found, (str, int, float, type(None))) else repr(found)
