# SPDX-License-Identifier: Apache-2.0
# Is beside engramConfig.cmake where the component `internals` is installed.
set(engram_internals_FOUND TRUE)
