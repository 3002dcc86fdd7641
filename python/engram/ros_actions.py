# SPDX-License-Identifier: Apache-2.0
"""Action servers of ROS 1 as skills: `python3 -m engram.ros_actions`; docs/skills.md.

A goal is an execution: the parameters become the message of the goal, feedback becomes reports, the
result the skill's result, and a stop cancels the goal.
"""

from __future__ import annotations

import argparse
import json
import signal
import sys
import threading
import time
from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

from engram.closing import Closing
from engram.errors import (
    EngramError,
    FailedPreconditionError,
    InvalidArgumentError,
    UnavailableError,
)
from engram.optional import MissingPackageError, needs
from engram.ros_messages import message_of, parameters_of, value_of
from engram.skills import Skill, SkillEnd, SkillProvider, SkillRun

_RESULT = "/result"
_AWAY_S = 2.0  # An action server that was not there for so long is gone.
_CANCELS_S = 4.5  # A little less than `stops_within` below.
_LOOK_S = 0.02


def action_servers() -> dict[str, str]:
    """The action servers that the master knows, and their types: {"/move_base":
    "move_base_msgs/MoveBase"}. Raises ConnectionError where no master answers."""
    rosgraph = needs("rosgraph", "action_servers")
    try:
        topics = rosgraph.Master("/engram_actions").getTopicTypes()
        published = {topic for topic, _ in rosgraph.Master("/engram_actions").getSystemState()[0]}
    except (OSError, rosgraph.MasterException) as error:
        raise ConnectionError(f"ROS master: {error}") from error
    ending = "ActionResult"
    return {
        topic.removesuffix(_RESULT): kind.removesuffix(ending)
        for topic, kind in sorted(topics)
        if topic in published and topic.endswith(_RESULT) and kind.endswith(ending)
    }


class RosActions(Closing):
    """The action servers of a ROS 1 master as skills of one provider.

        rospy.init_node("bridge", anonymous=True, disable_signals=True)
        with RosActions(SkillProvider("ros")) as actions:
            actions.follow()

    `frame`: the default of each frame in a goal. The node must have been initialised. Needs
    python3-actionlib. Threading: one thread.
    """

    def __init__(self, provider: SkillProvider, *, frame: str = "") -> None:
        self._actionlib = needs("actionlib", "RosActions")
        self._rospy = needs("rospy", "RosActions")
        self._provider = provider
        self._frame = frame
        self._skills: dict[str, str] = {}  # Names of actions -> names of their skills.
        self._clients: dict[str, Any] = {}

    @property
    def skills(self) -> dict[str, str]:
        """The skill of each action that has one."""
        return dict(self._skills)

    def add(self, action: str, kind: str) -> str:
        """Makes a skill of an action server; returns the skill's name. Raises InvalidArgumentError
        where the messages of `kind` are not installed; those of SkillProvider.add."""
        messages = _messages_of(kind)
        client = self._actionlib.SimpleActionClient(action, messages["action"])
        name = action.strip("/").replace("/", "_")
        description = {
            "name": name,
            "doc": f"The action server {action} of ROS, {kind}.",
            "parameters": parameters_of(messages["goal"], self._frame),
            # A server of actions cancels when it can, which may take a while.
            "stops_within": "5s",
        }

        # A goal may have a field `run`.
        def carry_out(run: SkillRun, /, **values: Any) -> SkillEnd:
            now = self._rospy.Time.now()
            return _carried_out(self._actionlib, client, message_of(messages["goal"], values, now), run)

        # JSON is YAML, too.
        try:
            self._provider.add(Skill(json.dumps(description), carry_out))
        except EngramError:
            client.action_client.stop()
            raise
        self._skills[action] = name
        self._clients[action] = client
        return name

    def remove(self, action: str) -> None:
        """The skill of an action server is no more. Raises UnavailableError where no server answers;
        then it still is."""
        self._provider.remove(self._skills[action])
        del self._skills[action]
        self._clients.pop(action).action_client.stop()

    def follow(
        self,
        wanted: Sequence[str] = (),
        *,
        on_change: Callable[[str, str, str], None] | None = None,
        is_over: Callable[[], bool] = lambda: False,
        every: float = 1.0,
    ) -> None:
        """Has a skill for each action server that there is, as they come and go; `wanted`: only for
        these. A master tells nobody what came, so it is asked each `every` seconds. `on_change` is
        told (action, type, what became of it). Returns when `is_over` says so, or the node ends."""
        tell = on_change or (lambda *_: None)
        problems: dict[str, str] = {}  # What was told of an action server, or "" of the master.
        while not is_over() and not self._rospy.is_shutdown():
            before, problems = problems, {}
            try:
                found = action_servers()
            except ConnectionError as error:
                problems[""] = str(error)
                found = dict.fromkeys(self._skills, "")  # Nobody knows, so they stay.
            for action in [one for one in self._skills if one not in found]:
                try:
                    self.remove(action)
                    tell(action, "", "has gone")
                except UnavailableError as error:
                    problems[action] = f"has gone, which the memory is told later: {error}"
            for action, kind in found.items():
                if action in self._skills or (wanted and action not in wanted):
                    continue
                try:
                    tell(action, kind, f"is the skill '{self.add(action, kind)}'")
                except EngramError as error:
                    problems[action] = f"is no skill: {error}"
            for action, problem in problems.items():
                if before.get(action) != problem:
                    tell(action, found.get(action, ""), problem)
            time.sleep(every)

    def close(self) -> None:
        """Leaves: what runs is stopped."""
        self._provider.close()


def _messages_of(kind: str) -> dict[str, Any]:
    message = needs("roslib.message", "RosActions")
    found = {}
    for key, ending in (("action", "Action"), ("goal", "Goal")):
        try:
            found[key] = message.get_message_class(kind + ending)
        except (ImportError, ValueError) as error:
            raise InvalidArgumentError(f"action of type {kind}: {error}") from error
        if found[key] is None:
            raise InvalidArgumentError(
                f"action of type {kind}: its messages are not installed for Python"
            )
    return found


def _is_there(client: Any) -> bool:
    """Whether the action server is connected, both ways: a goal that is sent before its feedback and
    its result can come loses them, and would be waited for without end. By the connections and not
    by time: that of ROS stands still where a simulator does."""
    names = ("pub_goal", "pub_cancel", "status_sub", "result_sub", "feedback_sub")
    topics = (getattr(client.action_client, name) for name in names)
    return all(topic.get_num_connections() > 0 for topic in topics)


def _carried_out(actionlib: ModuleType, client: Any, goal: Any, run: SkillRun) -> SkillEnd:
    """Sends a goal, and follows it until it has ended, within limits of the machine's clock."""
    begin = time.monotonic()
    while not _is_there(client):
        if run.wait(_LOOK_S) or time.monotonic() - begin > _AWAY_S:
            return SkillEnd(f"no action server answered within {_AWAY_S:g} s", "failure")

    def report(feedback: Any) -> None:
        try:
            run.report(value_of(feedback))
        except (UnavailableError, FailedPreconditionError):
            pass  # The provider connects again by itself; or the execution is over already.

    done = threading.Event()
    client.send_goal(goal, done_cb=lambda *_: done.set(), feedback_cb=report)
    seen = time.monotonic()
    cancelled = 0.0
    while not done.wait(_LOOK_S):
        now = time.monotonic()
        if run.is_stopped and not cancelled:
            cancelled = now
            client.cancel_goal()
        if _is_there(client):
            seen = now
        problem = ""
        if now - seen > _AWAY_S:
            problem = "its action server went away"
        elif cancelled and now - cancelled > _CANCELS_S:
            problem = f"its action server did not cancel within {_CANCELS_S:g} s"
        if problem:
            client.stop_tracking_goal()
            return SkillEnd(problem, "failure")
    return _end_of(actionlib, client)


def _end_of(actionlib: ModuleType, client: Any) -> SkillEnd:
    status = actionlib.GoalStatus
    state = client.get_state()
    outcome = {status.SUCCEEDED: "success", status.PREEMPTED: "stop", status.RECALLED: "stop"}
    words = {
        status.PREEMPTED: "cancelled while it ran",
        status.RECALLED: "cancelled before it ran",
        status.ABORTED: "aborted",
        status.REJECTED: "the goal was rejected",
        status.LOST: "its action server no longer knows the goal",
    }
    reason = ": ".join(one for one in (words.get(state, ""), client.get_goal_status_text()) if one)
    result = client.get_result()
    return SkillEnd(
        reason, outcome.get(state, "failure"), {} if result is None else value_of(result)
    )


def _arguments(argv: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python3 -m engram.ros_actions",
        description="Makes skills of the action servers of a ROS 1 master, until Ctrl-C.",
        epilog="example: python3 -m engram.ros_actions --provider base --action /move_base --frame map",
    )
    add = parser.add_argument
    add("--server", default="", help="endpoint of the memory server (default: the user's socket)")
    add("--provider", default="ros", help="name of the provider of these skills (default: ros)")
    only = "only this action server; may be repeated"
    add("--action", action="append", default=[], metavar="NAME", help=only)
    add("--frame", default="", help="the frame of poses where a request names none")
    add("--list", action="store_true", help="print the action servers that there are, and end")
    return parser.parse_args(argv)


def main(argv: Sequence[str] | None = None) -> int:
    """The program; returns its exit status."""
    arguments = _arguments(argv)
    try:
        rospy = needs("rospy", "engram.ros_actions")
        needs("actionlib", "engram.ros_actions")
    except MissingPackageError as error:
        print(error, file=sys.stderr)
        return 1
    rosgraph = needs("rosgraph", "engram.ros_actions")
    if not rosgraph.is_master_online():
        print(f"no ROS master answers at {rosgraph.get_master_uri()}", file=sys.stderr)
        return 1
    if arguments.list:
        for action, kind in action_servers().items():
            print(f"{action}  {kind}")
        return 0
    rospy.init_node("engram_actions", anonymous=True, disable_signals=True)
    # As Ctrl-C does, it stops what runs.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        with SkillProvider(arguments.provider, arguments.server) as provider:
            wanted = [one if one.startswith("/") else "/" + one for one in arguments.action]
            RosActions(provider, frame=arguments.frame).follow(wanted, on_change=_told)
    except KeyboardInterrupt:
        return 0
    except EngramError as error:
        print(error, file=sys.stderr)
        return 1
    finally:
        rospy.signal_shutdown("ended")
    return 0


def _told(action: str, kind: str, what: str) -> None:
    print(f"{action} {f'({kind}) ' if kind else ''}{what}".strip(), file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
