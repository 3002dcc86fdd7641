#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reads bags of ours with Python's rosbag.

check_bags.py example BAG COMPRESSION: what bag_interoperation_test.cpp has written into it.
check_bags.py silent BAG: it has a connection and no message.
check_bags.py same ORIGINAL COPY: both say the same. Rows of images that were padded are not any
more, and compressed images are PNG files.

Exits with 77 where rosbag is missing.
"""

import json
import struct
import sys

try:
    import rosbag
    import rospy
except ImportError as error:
    print(error, file=sys.stderr)
    sys.exit(77)

STRING_MD5 = "992ce8a1687cec8c8bd883ec73ca41d1"


def check(found, expected, what):
    if found != expected:
        sys.exit(f"{what}: is {found!r}, should be {expected!r}")


def topics_of(bag):
    return {topic: (info.msg_type, info.message_count, info.connections)
            for topic, info in bag.get_type_and_topic_info().topics.items()}


def check_example(path, compression):
    count = 50
    # Without allow_unindexed: the index must be whole.
    with rosbag.Bag(path, allow_unindexed=False) as bag:
        check(bag.version, 200, "version")
        check(bag.get_compression_info().compression, compression, "compression")
        if bag.get_compression_info().uncompressed < 50_000:
            sys.exit("needs several chunks")
        check(topics_of(bag), {
            "/A/B/c/reward": ("std_msgs/String", count, 1),
            "/RobotState/Proprioception/arm/joints": ("sensor_msgs/JointState", count, 1),
            "/Speech/Heard/head/said": ("std_msgs/String", count, 1),
            "/Vision/Depth/head/cam": ("sensor_msgs/Image", count, 1),
            "/Vision/RGB/head/cam": ("sensor_msgs/Image", count, 1),
        }, "topics")
        check(bag.get_type_and_topic_info().msg_types, {
            "sensor_msgs/Image": "060021388200f6f0f447d0fcd9c64743",
            "sensor_msgs/JointState": "3066dcd76a6cfaef579bd0f34173e9fd",
            "std_msgs/String": STRING_MD5,
        }, "MD5 sums")
        check(bag.get_message_count(), 5 * count, "messages")
        check(bag.get_start_time(), 1_700_000_000.0, "start")
        check(round(bag.get_end_time(), 3), 1_700_000_000.0 + 0.1 * (count - 1), "end")
        seen = {}
        for topic, message, time in bag.read_messages():
            index = seen[topic] = seen.get(topic, -1) + 1
            check(time, rospy.Time(1_700_000_000 + index // 10, index % 10 * 100_000_000), topic)
            check_value(topic, message, index)
        check(next(bag.read_messages(topics=["/Speech/Heard/head/said"],
                                     start_time=rospy.Time(1_700_000_002))).message.data,
              "number 20", "the first from a time on")
    # With an index it drops connections without messages.
    with rosbag.Bag(path, skip_index=True) as bag:
        check(sorted(connection.topic for connection in bag._get_connections())[1],
              "/A/B/c/silent", "connection without messages")


def check_value(topic, message, index):
    if topic == "/Speech/Heard/head/said":
        return check(message.data, f"number {index}", topic)
    if topic == "/A/B/c/reward":
        return check(json.loads(message.data), {"reward": index / 2}, topic)
    # 1 s before it was recorded.
    check(message.header.stamp, rospy.Time(1_699_999_999 + index // 10, index % 10 * 100_000_000),
          f"{topic}: stamp")
    if topic == "/RobotState/Proprioception/arm/joints":
        return check((message.name, message.position, message.velocity, message.effort),
                     (["left", "right"], (0.5, float(index)), (), ()), topic)
    is_depth = "Depth" in topic
    check((message.height, message.width, message.is_bigendian), (16, 24, 0), topic)
    check(message.encoding, "16UC1" if is_depth else "rgb8", topic)
    check(message.step, 48 if is_depth else 72, topic)
    pixels = ([(index * 1000 + i) % 65536 for i in range(16 * 24)] if is_depth
              else [(index + i) % 256 for i in range(16 * 24 * 3)])
    check(message.data, struct.pack("<384H", *pixels) if is_depth else bytes(pixels), topic)


def check_silent(path):
    with rosbag.Bag(path, allow_unindexed=False) as bag:
        check(bag.get_message_count(), 0, "messages")
        check(list(bag.read_messages()), [], "messages")
    with rosbag.Bag(path, skip_index=True) as bag:
        check([connection.topic for connection in bag._get_connections()], ["/A/B/c/silent"],
              "connections")


def messages_of(bag):
    """Sorted: at one time, connections may be in any order."""
    return sorted(((time, topic, raw[0], raw[1], raw[2]) for topic, raw, time in
                   bag.read_messages(raw=True)))


def check_image(topic, before, after):
    """An image without what padded its rows."""
    for name in ("header", "height", "width", "encoding", "is_bigendian"):
        check(getattr(after, name), getattr(before, name), f"{topic}: {name}")
    if before.step <= after.step:
        sys.exit(f"{topic}: other bytes, though its rows were not padded")
    rows = [before.data[y * before.step:y * before.step + after.step]
            for y in range(before.height)]
    check(after.data, b"".join(rows), f"{topic}: pixels")


def check_same(original, copy):
    with rosbag.Bag(original) as before, rosbag.Bag(copy, allow_unindexed=False) as after:
        check(topics_of(after), topics_of(before), "topics")
        check(after.get_type_and_topic_info().msg_types,
              before.get_type_and_topic_info().msg_types, "MD5 sums")
        check(after.get_start_time(), before.get_start_time(), "start")
        check(after.get_end_time(), before.get_end_time(), "end")
        check(after.get_message_count(), before.get_message_count(), "messages")
        headers = [{connection.topic: (connection.header, connection.msg_def)
                    for connection in bag._get_connections()} for bag in (before, after)]
        check(headers[1], headers[0], "connections")
        same = 0
        types = {topic: type(message) for topic, message, _ in after.read_messages()}
        for one, other in zip(messages_of(before), messages_of(after)):
            check(other[:3] + other[4:], one[:3] + one[4:], "message")
            if one == other:
                same += 1
                continue
            parsed = [types[one[1]]().deserialize(raw[3]) for raw in (one, other)]
            if one[2] == "sensor_msgs/Image":
                check_image(one[1], *parsed)
            elif one[2] == "sensor_msgs/CompressedImage":
                check(parsed[1].header, parsed[0].header, one[1])
                # PNG, and as large as the original.
                check(parsed[1].data[:24], b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x08\0\0\0\x08",
                      one[1])
            else:
                sys.exit(f"{one[1]}: other bytes")
        # Of nine topics, two with padded rows and one that is compressed.
        check(same, after.get_message_count() // 9 * 6, "messages that are the same")


if __name__ == "__main__":
    checks = {"example": check_example, "silent": check_silent, "same": check_same}
    checks[sys.argv[1]](*sys.argv[2:])
