# SPDX-License-Identifier: Apache-2.0
"""Blocks that are read rather than run: YAML, JSON, XML, unit files, CMake and C++."""

from __future__ import annotations

import configparser
import json
import pathlib
import shlex
import subprocess
import xml.dom.minidom
import xml.parsers.expat

import yaml  # type: ignore[import]

from sandbox import BlockError

_COMPILED_LIKE = "cli/CMakeFiles/engram_program.dir/"  #: Its flags find every header.

_CMAKE_CONFIG = """\
foreach(library core idf memory typed store recording recall client)
  add_library(engram::${library} INTERFACE IMPORTED)
endforeach()
add_executable(engram::idf_tool IMPORTED)
set_target_properties(engram::idf_tool PROPERTIES IMPORTED_LOCATION "%s")
include("%s/cmake/EngramIdfTypes.cmake")
"""


def check_data(language: str, text: str) -> None:
    """Parses YAML, JSON, JSON lines, XML or a unit file. Raises BlockError."""
    try:
        if language == "yaml":
            if yaml.safe_load(text) is None:
                raise BlockError("is empty")
        elif language == "json":
            for one in _json_documents(text):
                json.loads(one)
        elif language == "xml":
            xml.dom.minidom.parseString(text.strip())
        elif language == "ini":
            configparser.RawConfigParser(strict=False, interpolation=None).read_string(text)
    except (yaml.YAMLError, json.JSONDecodeError, xml.parsers.expat.ExpatError,
            configparser.Error) as error:
        raise BlockError(f"is no {language}: {error}") from error


def _json_documents(text: str) -> list[str]:
    lines = [line for line in text.split("\n") if line.strip()]
    is_lines = len(lines) > 1 and all(line.startswith("{") and line.endswith("}") for line in lines)
    return lines if is_lines else [text]


def check_cmake(text: str, folder: pathlib.Path, source: pathlib.Path) -> None:
    """Configures a project that is this block, with the real functions and empty libraries."""
    project = folder / ".box" / "cmake"
    (project / "package").mkdir(parents=True, exist_ok=True)
    (project / "package" / "engramConfig.cmake").write_text(_CMAKE_CONFIG % ("/bin/true", source))
    (folder / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.25)\nproject(block LANGUAGES CXX)\n" + text)
    done = subprocess.run(
        ["cmake", "-S", folder, "-B", project / "build", "-G", "Ninja",
         f"-Dengram_DIR={project / 'package'}"],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode:
        raise BlockError(f"CMake refuses it:\n{done.stdout}")


def check_cpp(text: str, folder: pathlib.Path, line: int, name: str,
              flags: list[str]) -> None:
    """Compiles a translation unit, without making code. Raises BlockError with the messages."""
    unit = folder / ".box" / "block.cpp"
    unit.write_text(f'#line {line} "{name}"\n{text}')
    done = subprocess.run(["c++", "-fsyntax-only", "-Wall", "-Wno-unused-variable",
                           "-Wno-unused-function", *flags, f"-I{folder}", str(unit)],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode:
        raise BlockError(f"does not compile:\n{done.stdout[:4000]}")


def flags_of(compile_commands: pathlib.Path) -> list[str]:
    """The flags by which headers are found and understood, from what the build notes."""
    for entry in json.loads(compile_commands.read_text()):
        if _COMPILED_LIKE in entry["command"]:
            return _header_flags(shlex.split(entry["command"]))
    raise BlockError(f"{compile_commands}: has no {_COMPILED_LIKE}")


def _header_flags(words: list[str]) -> list[str]:
    flags = []
    for at, word in enumerate(words):
        if word == "-isystem":
            flags += [word, words[at + 1]]
        elif word.startswith(("-I", "-D", "-std=")):
            flags.append(word)
    return flags
