// SPDX-License-Identifier: Apache-2.0
// What the rooms of server/ that speak gRPC include.
#pragma once

#include <engram/v1/memory.grpc.pb.h>
#include <engram/v1/memory.pb.h>
#include <grpcpp/grpcpp.h>

#include "standard.h"
