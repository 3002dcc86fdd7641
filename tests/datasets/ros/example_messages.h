// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <string_view>
#include <vector>

#include "datasets/ros/message_type.h"

namespace engram::datasets::ros {

inline std::vector<std::byte> from_hex(std::string_view text) {
  std::vector<std::byte> bytes;
  for (size_t i = 0; i + 1 < text.size(); i += 2) {
    uint8_t value = 0;
    std::from_chars(text.data() + i, text.data() + i + 2, value, 16);
    bytes.push_back(std::byte{value});
  }
  return bytes;
}

// As genmsg of ROS 1 gives them, without most comments.
inline constexpr std::string_view kRos1Header =
    "================================================================================\n"
    "MSG: std_msgs/Header\n"
    "uint32 seq # counts = up\n"
    "time stamp\n"
    "string frame_id\n";
inline constexpr std::string_view kRos1JointState =
    "# state of joints\n\nHeader header\n\nstring[] name\nfloat64[] position\nfloat64[] velocity\n"
    "float64[] effort\n\n";
inline constexpr std::string_view kRos1Transforms =
    "geometry_msgs/TransformStamped[] transforms\n"
    "================================================================================\n"
    "MSG: geometry_msgs/TransformStamped\n"
    "Header header\nstring child_frame_id # of the child\nTransform transform\n"
    "================================================================================\n"
    "MSG: geometry_msgs/Transform\nVector3 translation\nQuaternion rotation\n"
    "================================================================================\n"
    "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n"
    "================================================================================\n"
    "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";

// What genpy 0.6.16 made of these types (Debian 12, python3-sensor-msgs, python3-tf2-msgs).
inline constexpr std::string_view kRos1JointStateBytes =
    "07000000f0990f62f019561d04000000626173650200000005000000656c626f770500000077726973740200000000"
    "0000000000e03f000000000000f4bf00000000010000000000000000000840";
inline constexpr std::string_view kRos1ImageBytes =
    "07000000f0990f62f019561d0400000062617365020000000100000004000000626772380004000000080000000102"
    "030904050609";
inline constexpr std::string_view kRos1TransformBytes =
    "0100000007000000f0990f62f019561d040000006261736504000000746f6f6c000000000000f83f00000000000000"
    "000000000000000000000000000000000000000000000000000000000000000000000000000000f03f";

// What Fast-CDR 1.0.26 made of them (Debian 12, libfastcdr-dev).
inline constexpr std::string_view kCdrJointStateBytes =
    "00010000f0990f62f019561d0500000062617365000000000200000006000000656c626f7700000006000000777269"
    "73740000000200000000000000000000000000e03f000000000000f4bf00000000010000000000000000000840";
inline constexpr std::string_view kCdrJointStateBigEndianBytes =
    "00000000620f99f01d5619f000000005626173650000c03f0000000200000006656c626f7700ffff00000006777269"
    "737400f03f00000002000000403fe0000000000000bff400000000000000000000000000014008000000000000";
inline constexpr std::string_view kMixedDefinition =
    "uint8 KINDS=3\nstring NAME = a # b\n"
    "uint8 a\nuint16 b\nbool c\nuint64 d\nfloat32 e 1.5\nstring<=4 f\nint8 g\nint64 h\n"
    "float64[3] i\nuint16[<=4] j\nuint8 k\n";
inline constexpr std::string_view kCdrMixedBytes =
    "000100000700010201000000feffffffffffffff0000c03f020000007800fd00656c626ffbffffffffffffff000000"
    "000000f03f000000000000004000000000000008400200000002010300ff";
inline constexpr std::string_view kCdrMixedBigEndianBytes =
    "000000000700020101000000fffffffffffffffe3fc00000000000027800fd06656c626ffffffffffffffffb3ff000"
    "0000000000400000000000000040080000000000000000000201020003ff";

}  // namespace engram::datasets::ros
