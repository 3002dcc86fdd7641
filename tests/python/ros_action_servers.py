# SPDX-License-Identifier: Apache-2.0
"""Real action servers of ROS 1, for ros_actions_test.py: /base/move (MoveBase), which aborts what is
farther than 100 m and goes on for ever below 0, and /count (actionlib's Test), which sleeps below
0."""

import time

import actionlib
import actionlib.msg
import move_base_msgs.msg
import rospy


def move(server, goal):
    target = goal.target_pose
    x = target.pose.position.x
    if x > 100:
        server.set_aborted(text=f"{x} m is too far in {target.header.frame_id}")
        return
    feedback = move_base_msgs.msg.MoveBaseFeedback()
    steps = 0
    while x < 0 or steps < 3:
        if server.is_preempt_requested():
            server.set_preempted(text="standing")
            return
        feedback.base_position.pose.position.x = x * steps / 3
        server.publish_feedback(feedback)
        rospy.sleep(0.05)
        steps += 1
    server.set_succeeded(text=f"at {x}, heading {target.pose.orientation.w:.1f}")


def count(server, goal):
    if goal.goal < 0:
        time.sleep(-goal.goal)  # It does not look whether it is to stop.
    server.set_succeeded(actionlib.msg.TestResult(result=goal.goal + 1))


rospy.init_node("action_servers")
servers = []
for name, action, function in (("/base/move", move_base_msgs.msg.MoveBaseAction, move),
                               ("/count", actionlib.msg.TestAction, count)):
    server = actionlib.SimpleActionServer(
        name, action, lambda goal, f=function, i=len(servers): f(servers[i], goal),
        auto_start=False)
    servers.append(server)
    server.start()
print("ready", flush=True)
rospy.spin()
