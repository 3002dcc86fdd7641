// SPDX-License-Identifier: Apache-2.0
#pragma once

// BehaviorTree.CPP in the version that is installed: 4, or 3 as robots with ROS Noetic have it.
#if __has_include(<behaviortree_cpp/bt_factory.h>)
#include <behaviortree_cpp/action_node.h>
#include <behaviortree_cpp/bt_factory.h>
#define ENGRAM_BEHAVIOR_TREE_WAKES 1
#else
#include <behaviortree_cpp_v3/action_node.h>
#include <behaviortree_cpp_v3/bt_factory.h>
#define ENGRAM_BEHAVIOR_TREE_WAKES 0
#endif
