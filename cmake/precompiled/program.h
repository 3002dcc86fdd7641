// SPDX-License-Identifier: Apache-2.0
// What the commands of the program include.
#pragma once

#include <CLI/CLI.hpp>

#include "standard.h"
