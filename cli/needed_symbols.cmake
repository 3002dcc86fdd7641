# SPDX-License-Identifier: Apache-2.0
# cmake -DNM=... -DMODULE=engram-learning.so -DOPTIONS=file -P needed_symbols.cmake
#
# Writes the linker's options with which the program has, and exports, what a module takes from it:
# functions, methods and vtables of namespace engram. The link fails where one of them is missing.
execute_process(COMMAND ${NM} -D --undefined-only ${MODULE} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "_Z(T[A-Z])?N[KRO]*6engram[A-Za-z0-9_]+" symbols "${symbols}")
list(TRANSFORM symbols REPLACE "(.+)" "--require-defined=\\1\n--export-dynamic-symbol=\\1\n")
list(JOIN symbols "" options)
file(WRITE ${OPTIONS} "${options}")
