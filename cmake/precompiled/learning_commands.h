// SPDX-License-Identifier: Apache-2.0
// What the commands that learn include: those of the program, for a module.
#pragma once

#include "program.h"
