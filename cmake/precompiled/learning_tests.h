// SPDX-License-Identifier: Apache-2.0
// What tests of networks include: LibTorch's headers cost 16 s each time that they are parsed.
#pragma once

#include <torch/torch.h>

#include "tests.h"
