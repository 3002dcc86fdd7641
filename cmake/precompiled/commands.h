// SPDX-License-Identifier: Apache-2.0
// What the commands of the programs and of the module include.
#pragma once

#include <CLI/CLI.hpp>

#include "standard.h"
