# SPDX-License-Identifier: Apache-2.0
"""Action servers of ROS 1 as skills, against real ones: ros_actions_test.py ENGRAM.

A master, action servers, the bridge and a memory server are processes of their own.
"""

import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from unittest import mock

import numpy as np
from actionlib.msg import TestResult
from actionlib_msgs.msg import GoalStatusArray
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from move_base_msgs.msg import MoveBaseGoal
from sensor_msgs.msg import JointState
from served import Server
from tf2_msgs.msg import LookupTransformGoal

import engram
from engram.errors import InvalidArgumentError
from engram.ros_actions import _is_there
from engram.ros_messages import message_of, parameters_of, value_of

PROGRAM = sys.argv.pop()
HERE = pathlib.Path(__file__).parent
AT = {"position": [1.5, 2.0, 0.0], "orientation": [1.0, 0.0, 0.0, 0.0]}


def free_port():
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


class MessagesTest(unittest.TestCase):
    def test_a_goal_becomes_parameters_and_back(self):
        self.assertEqual(parameters_of(MoveBaseGoal, "map"), {
            "target_pose_frame": {"type": "string", "default": "map"},
            "target_pose": {"type": "pose"},
        })
        goal = message_of(MoveBaseGoal, {"target_pose_frame": "odom", "target_pose": AT})
        self.assertEqual(goal.target_pose.header.frame_id, "odom")
        self.assertEqual(goal.target_pose.pose.position.x, 1.5)
        self.assertEqual(goal.target_pose.pose.orientation.w, 1)
        self.assertEqual(goal.target_pose.pose.orientation.z, 0)

    def test_times_durations_texts_and_flags(self):
        described = parameters_of(LookupTransformGoal)
        self.assertEqual(described["timeout"], {"type": "double", "unit": "s", "default": 0})
        self.assertEqual(described["advanced"], {"type": "bool", "default": False})
        values = {name: one.get("default") for name, one in described.items()}
        goal = message_of(LookupTransformGoal,
                          values | {"source_time": 1_500_000_000_250_000_000, "timeout": 0.5,
                                    "target_frame": "map", "advanced": True})
        self.assertEqual((goal.source_time.secs, goal.source_time.nsecs), (1_500_000_000, 250_000_000))
        self.assertEqual((goal.timeout.to_sec(), goal.target_frame, goal.advanced),
                         (0.5, "map", True))
        value = value_of(goal)
        self.assertEqual(value["source_time"], 1_500_000_000_250_000_000)
        self.assertEqual((value["timeout"], value["target_frame"]), (0.5, "map"))

    def test_two_fields_of_one_name_are_refused(self):
        class Twice:
            __slots__ = ["pose_frame", "pose"]
            _slot_types = ["string", "geometry_msgs/PoseStamped"]

            def __init__(self):
                self.pose_frame, self.pose = "", PoseStamped()

        with self.assertRaisesRegex(InvalidArgumentError, "parameter 'pose_frame'"):
            parameters_of(Twice)

    def test_arrays_of_a_wrong_length_are_named(self):
        described = parameters_of(PoseWithCovarianceStamped)
        self.assertEqual(described["pose_covariance"], {"type": "numbers", "default": [0] * 36})
        with self.assertRaisesRegex(InvalidArgumentError, "pose_covariance.*3.*float64.36."):
            message_of(PoseWithCovarianceStamped,
                       {"header_frame": "", "pose_pose": AT, "pose_covariance": [1, 2, 3]})

    def test_lists_of_texts_and_messages_are_json(self):
        values = {"header_frame": "", "name": '["a", "b"]', "position": np.array([1.0, 2.0]),
                  "velocity": [], "effort": []}
        state = message_of(JointState, values)
        self.assertEqual((state.name, state.position), (["a", "b"], [1, 2]))
        back = value_of(state)
        self.assertEqual(back["name"], ["a", "b"])
        np.testing.assert_array_equal(back["position"], [1, 2])
        for wrong in ("{", '{"a": 1}', "3"):
            with self.assertRaisesRegex(InvalidArgumentError, "'name'"):
                message_of(JointState, values | {"name": wrong})
        of_messages = {"header_frame": "", "status_list": '[{"status": 3, "text": "done"}]'}
        made = message_of(GoalStatusArray, of_messages)
        self.assertEqual((made.status_list[0].status, made.status_list[0].text), (3, "done"))
        self.assertEqual(value_of(made)["status_list"][0]["text"], "done")
        with self.assertRaisesRegex(InvalidArgumentError, "'status_list'"):
            message_of(GoalStatusArray, of_messages | {"status_list": '[{"colour": 3}]'})

    def test_defaults_are_what_ros_has(self):
        for kind in (LookupTransformGoal, PoseWithCovarianceStamped, JointState, GoalStatusArray):
            given = {name: one.get("default", AT) for name, one in parameters_of(kind).items()}
            message, plain = message_of(kind, given), kind()
            if kind is PoseWithCovarianceStamped:  # A pose of zeros is none.
                plain.pose.pose = message.pose.pose
                message.pose.covariance = tuple(message.pose.covariance)
                plain.pose.covariance = tuple(plain.pose.covariance)
            self.assertEqual(message, plain, kind)
        self.assertEqual(value_of(TestResult(result=7)), {"result": 7})

    def test_a_pose_is_a_value_as_everywhere(self):
        pose = PoseStamped()
        pose.pose.position.y, pose.pose.orientation.w = 2, 1
        value = value_of(pose)
        np.testing.assert_array_equal(value["pose"]["position"], [0, 2, 0])
        np.testing.assert_array_equal(value["pose"]["orientation"], [1, 0, 0, 0])


class ConnectionTest(unittest.TestCase):
    def test_a_server_is_there_when_goals_and_results_can_pass(self):
        topics = ("pub_goal", "pub_cancel", "status_sub", "result_sub", "feedback_sub")
        for missing in ("", *topics):
            client = mock.Mock()
            for topic in topics:
                getattr(client.action_client, topic).get_num_connections.return_value = (
                    0 if topic == missing else 1)
            self.assertEqual(_is_there(client), missing == "", missing)


class BridgeTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path = pathlib.Path(folder.name)
        port = free_port()
        self.environment = os.environ | {
            "ROS_MASTER_URI": f"http://127.0.0.1:{port}", "ROS_IP": "127.0.0.1",
            "ROS_HOME": folder.name, "ROS_LOG_DIR": folder.name,
        }
        self.run_program("rosmaster", "--core", "-p", str(port))
        self.server = Server(PROGRAM, path, path / "robot.engram")
        self.addCleanup(self.server.kill)
        self.memory = engram.connect(self.server.endpoint)
        self.addCleanup(self.memory.close)

    def run_program(self, *command, out=subprocess.DEVNULL, err=subprocess.DEVNULL):
        process = subprocess.Popen(command, env=self.environment, stdout=out, stderr=err, text=True)
        self.addCleanup(self.end, process)
        return process

    def end(self, process):
        process.kill()
        process.communicate(timeout=30)

    def start_servers(self):
        for _ in range(100):  # The master may not listen yet.
            servers = self.run_program(sys.executable, str(HERE / "ros_action_servers.py"),
                                       out=subprocess.PIPE)
            if servers.stdout.readline() == "ready\n":
                return servers
        self.fail("the action servers did not start")

    def start_bridge(self, *options):
        bridge = self.run_program(sys.executable, "-m", "engram.ros_actions", "--server",
                                  self.server.endpoint, "--provider", "ros", *options,
                                  err=subprocess.PIPE)
        self.said = []
        reader = threading.Thread(target=lambda: self.said.extend(iter(bridge.stderr.readline, "")))
        reader.start()
        self.addCleanup(reader.join)
        self.addCleanup(self.end, bridge)
        return bridge

    def wait_until(self, what, seconds=20.0):
        until = time.monotonic() + seconds
        while not what():
            self.assertLess(time.monotonic(), until, self.said)
            time.sleep(0.05)

    def run_skill(self, name, **parameters):
        return engram.run_skill(self.memory, name, parameters, timeout=20)

    def test_goals_are_executions(self):
        servers = self.start_servers()
        bridge = self.start_bridge("--frame", "map")
        self.wait_until(lambda: sum("is the skill" in one for one in self.said) == 2)

        counted = self.run_skill("ros/count", goal=41)
        self.assertEqual((counted.outcome, counted.result), ("success", {"result": 42}))
        moved = self.run_skill("ros/base_move", target_pose=AT)
        self.assertEqual((moved.outcome, moved.reason), ("success", "at 1.5, heading 1.0"))
        events = self.memory["Skill/Event/ros/base_move"].snapshots()
        stages = [one.value["stage"] for one in events]
        # Feedback and results are topics of their own, so the last feedback may come too late.
        self.assertEqual((stages[:2], stages[-1]), ([0, 1], 2), stages)
        self.assertEqual(set(stages[1:-1]), {1}, stages)
        self.assertLessEqual(len(stages), 5, stages)

        far = {"position": [101.0, 0, 0], "orientation": [1.0, 0, 0, 0]}
        aborted = self.run_skill("ros/base_move", target_pose=far)
        self.assertEqual(aborted.outcome, "failure")
        self.assertEqual(aborted.reason, "aborted: 101.0 m is too far in map")
        refused = self.run_skill("ros/count", goal=2**31)
        self.assertEqual(refused.outcome, "refused")
        self.assertIn("goal", refused.reason)

        for end, outcome, reason in ((self.stop_skill, "stop",
                                      "somebody asked to stop it; cancelled while it ran: standing"),
                                     (servers.kill, "failure", "its action server went away")):
            results = []
            back = {"position": [-1.0, 0, 0], "orientation": [1.0, 0, 0, 0]}
            asked = threading.Thread(
                target=lambda: results.append(self.run_skill("ros/base_move", target_pose=back)))
            before = self.events_of("base_move")
            asked.start()
            self.wait_until(lambda: self.events_of("base_move") > before + 1)
            end()
            asked.join()
            self.assertEqual((results[0].outcome, results[0].reason), (outcome, reason))

        bridge.send_signal(signal.SIGINT)
        self.assertEqual(bridge.wait(timeout=30), 0, self.said)

    def events_of(self, skill):
        try:
            return len(self.memory[f"Skill/Event/ros/{skill}"].times())
        except LookupError:
            return 0

    def stop_skill(self):
        subprocess.run([PROGRAM, "skill", "stop", "ros/base_move", "--server", self.server.endpoint],
                       check=True, capture_output=True)

    def test_a_server_that_does_not_cancel_ends_no_bridge(self):
        self.start_servers()
        bridge = self.start_bridge("--frame", "map")
        self.wait_until(lambda: sum("is the skill" in one for one in self.said) == 2)
        results = []
        asked = threading.Thread(  # /count sleeps so long, whatever it is told.
            target=lambda: results.append(self.run_skill("ros/count", goal=-20)))
        asked.start()
        self.wait_until(lambda: self.events_of("count") == 1)
        bridge.send_signal(signal.SIGTERM)
        self.assertEqual(bridge.wait(timeout=15), 0, self.said)
        asked.join()
        self.assertEqual(results[0].outcome, "failure")

    def test_action_servers_may_come_later_and_go(self):
        # The master must be there, though.
        self.start_servers().send_signal(signal.SIGINT)
        self.start_bridge("--action", "count")
        servers = self.start_servers()
        self.wait_until(lambda: any("/count" in one and "is the skill" in one for one in self.said))
        self.assertFalse(any("base" in one for one in self.said), self.said)
        servers.send_signal(signal.SIGINT)  # It says goodbye to the master.
        self.wait_until(lambda: any("has gone" in one for one in self.said))

    def test_list_tells_the_action_servers(self):
        self.start_servers()
        listed = subprocess.run([sys.executable, "-m", "engram.ros_actions", "--list"],
                                env=self.environment, capture_output=True, text=True, check=True)
        self.assertEqual(listed.stdout, "/base/move  move_base_msgs/MoveBase\n/count  actionlib/Test\n")

    def test_no_master_is_an_error(self):
        self.environment["ROS_MASTER_URI"] = f"http://127.0.0.1:{free_port()}"
        done = subprocess.run([sys.executable, "-m", "engram.ros_actions", "--list"],
                              env=self.environment, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("no ROS master answers at http://127.0.0.1", done.stderr)


if __name__ == "__main__":
    unittest.main()
