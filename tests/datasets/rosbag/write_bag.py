#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes a bag with Python's rosbag: write_bag.py OUT COMPRESSION [IMAGES HEIGHT WIDTH].

With a number of images it holds those alone. Exits with 77 where rosbag is missing.
"""

import base64
import struct
import sys

try:
    import rosbag
    import rospy
    from geometry_msgs.msg import PoseStamped, TransformStamped
    from sensor_msgs.msg import CompressedImage, Image, JointState
    from std_msgs.msg import String
    from tf2_msgs.msg import TFMessage
except ImportError as error:
    print(error, file=sys.stderr)
    sys.exit(77)

# 8 x 8 pixels of one colour.
JPEG = base64.b64decode(
    "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDABALDA4MChAODQ4SERATGCgaGBYWGDEjJR0oOjM9PDkzODdASFxOQERX"
    "RTc4UG1RV19iZ2hnPk1xeXBkeFxlZ2P/2wBDARESEhgVGC8aGi9jQjhCY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2Nj"
    "Y2NjY2NjY2NjY2NjY2NjY2NjY2NjY2NjY2P/wAARCAAIAAgDASIAAhEBAxEB/8QAFQABAQAAAAAAAAAAAAAAAAAA"
    "AAL/xAAUEAEAAAAAAAAAAAAAAAAAAAAA/8QAFAEBAAAAAAAAAAAAAAAAAAAABf/EABQRAQAAAAAAAAAAAAAAAAAA"
    "AAD/2gAMAwEAAhEDEQA/AJAFmX//2Q==")


def stamped(message, nanoseconds, frame):
    message.header.stamp = rospy.Time(1_600_000_000, nanoseconds)
    message.header.frame_id = frame
    return message


def image(encoding, height, width, step, data, index):
    message = stamped(Image(), index, "camera")
    message.encoding, message.height, message.width, message.step = encoding, height, width, step
    message.data = data
    return message


def write_all(bag, index):
    time = rospy.Time(1_700_000_000, index * 100_000_000)
    # Two rows of two pixels and two bytes that pad each.
    row = bytes([index, 1, 2, 3, 4, 5, 0, 0])
    bag.write("/camera/rgb", image("rgb8", 2, 2, 8, row * 2, index), time)
    bag.write("/camera/bgr", image("bgr8", 2, 2, 8, row * 2, index), time)
    bag.write("/camera/mono", image("mono8", 2, 2, 2, bytes([index, 1, 2, 3]), index), time)
    depth = struct.pack("<4H", index, 1000, 2000, 65535)
    bag.write("/camera/depth", image("16UC1", 2, 2, 4, depth, index), time)
    compressed = stamped(CompressedImage(), index, "camera")
    compressed.format, compressed.data = "rgb8; jpeg compressed bgr8", JPEG
    bag.write("/camera/compressed", compressed, time)
    joints = stamped(JointState(), index, "")
    joints.name, joints.position = ["left", "right"], [0.5, float(index)]
    bag.write("joint_states", joints, time)
    transform = stamped(TransformStamped(), index, "world")
    transform.child_frame_id = "base"
    transform.transform.translation.x = float(index)
    transform.transform.rotation.w = 1.0
    bag.write("/tf", TFMessage([transform]), time)
    pose = stamped(PoseStamped(), index, "map")
    pose.pose.position.y = float(index)
    bag.write("/pose", pose, time)
    about = {"topic": "/text", "type": "std_msgs/String", "callerid": "/talker", "latching": "1",
             "md5sum": String._md5sum, "message_definition": String._full_text}
    bag.write("/text", String(f"number {index}"), time, connection_header=about)


def main():
    path, compression = sys.argv[1:3]
    images, height, width = map(int, sys.argv[3:6]) if len(sys.argv) > 3 else (0, 0, 0)
    with rosbag.Bag(path, "w", compression=compression, chunk_threshold=2048) as bag:
        for index in range(images):
            row = bytes((index + x) % 256 for x in range(width * 3))
            time = rospy.Time(1_700_000_000, 0) + rospy.Duration(0, index * 1_000_000)
            bag.write("/camera/rgb", image("rgb8", height, width, width * 3, row * height, index),
                      time)
        for index in range(0 if images else 3):
            write_all(bag, index)


if __name__ == "__main__":
    main()
