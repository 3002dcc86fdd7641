# SPDX-License-Identifier: Apache-2.0
"""Checks the sources against the table of rooms and floors in docs/design.md, section 3.

floors.py ROOT            the problems, one on each line
floors.py ROOT --count    how many rooms and arrows there are
"""

import re
import sys
from pathlib import Path

# What a name in the table means in #include lines.
LIBRARIES = {
    "std": (),
    "fmt": ("fmt/",),
    "spdlog": ("spdlog/",),
    "yaml-cpp": ("yaml-cpp/",),
    "nlohmann/json": ("nlohmann/",),
    "pugixml": ("pugixml.hpp",),
    "re2": ("re2/",),
    "lz4": ("lz4frame.h",),
    "bzip2": ("bzlib.h",),
    "zstd": ("zstd.h", "zdict.h"),
    "zlib": ("zlib.h",),
    "OpenCV": ("opencv2/",),
    "libspng": ("spng.h",),
    "libjpeg-turbo": ("turbojpeg.h",),
    "Eigen": ("Eigen/",),
    "libav*": ("libav", "libsw"),
    "hdf5": ("hdf5",),
    "xxhash": ("xxhash.h",),
    "LibTorch": ("torch/", "ATen/", "c10/"),
    "CLI11": ("CLI/",),
    "gRPC": ("grpcpp/", "grpc/"),
    "protobuf": ("google/protobuf/", "engram/v1/"),
    "OpenSSL": ("openssl/",),
    "pybind11": ("pybind11/",),
    "MuJoCo": ("mujoco/",),
    "EGL": ("EGL/",),
    "Boost": ("boost/",),
    "OMPL": ("ompl/",),
    "libcurl": ("curl/",),
    "BehaviorTree.CPP": ("behaviortree_cpp/", "behaviortree_cpp_v3/"),
}
# These stay where they are, whoever may include the room.
CONFINED = {
    "hdf5": {"ltm/h5"},
    "LibTorch": {
        "encoders",
        "training/fit",
        "training/forms",
        "training/night",
        "training/measure",
    },
    "CLI11": {"cli"},
    "MuJoCo": {"datasets/kitchen", "datasets"},
    "EGL": {"datasets/kitchen", "datasets"},
    "Boost": {"viewer"},
    "OMPL": {"server/navigation", "server"},
    "libcurl": {"speech/assistants"},
    "BehaviorTree.CPP": {"server/behavior_tree", "server"},
}
SYSTEM = re.compile(
    r"^([a-z0-9_]+|sys/.*|linux/.*|netinet/.*|arpa/.*"
    r"|(unistd|dirent|fcntl|signal|pthread|poll|stdlib|malloc|mntent|termios|dlfcn|sched|spawn|emmintrin)\.h)$"
)
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')
MAX_LINES = 600


class Room:
    def __init__(self, folder, rooms, libraries, is_free):
        self.folder = folder
        self.rooms = rooms
        self.libraries = libraries
        self.is_free = is_free


def read_table(design):
    """The rooms of the table, by folder. Raises ValueError where a name means nothing."""
    section = design.split("## 3. Rooms and floors", 1)[1].split("\n## ", 1)[0]
    rows = re.findall(r"^\| `([a-z0-9_/]+)` \|.*\| ([^|]+) \|$", section, re.MULTILINE)
    folders = [folder.rstrip("/") for folder, _ in rows]
    rooms = {}
    for folder, (_, cell) in zip(folders, rows):
        below, libraries, is_free = set(), set(), False
        for name in (part.strip() for part in cell.split(",")):
            if name == "all above":
                below.update(rooms)
            elif name in ("anything", "installed project"):
                is_free = True
            elif name in LIBRARIES:
                libraries.add(name)
            elif name.endswith("/") and name.rstrip("/") in folders:
                below.add(name.rstrip("/"))
            elif "ltm/" + name in folders:
                below.add("ltm/" + name)
            elif name in folders:
                below.add(name)
            else:
                raise ValueError(f"docs/design.md: '{folder}' may include '{name}', which is nothing")
        rooms[folder] = Room(folder, below, libraries, is_free)
    return rooms


def closure(rooms, folder):
    """The room itself and all that it may include, directly or not."""
    seen, waiting = set(), [folder]
    while waiting:
        current = waiting.pop()
        if current not in seen:
            seen.add(current)
            waiting.extend(rooms[current].rooms)
    return seen


def sources(folder, suffixes):
    return sorted(path for path in folder.rglob("*") if path.suffix in suffixes and path.is_file())


def library_of(name):
    for library, prefixes in LIBRARIES.items():
        if name.startswith(prefixes):
            return library
    return None


def check_include(rooms, room, kind, name):
    """What is wrong with an include of `name` in `room`; None where nothing is."""
    reachable = closure(rooms, room)
    if kind == '"':
        owners = [folder for folder in rooms if name.startswith(folder + "/")]
        if not owners:
            return f'"{name}" is not named from the root of the repository'
        return None if owners[0] in reachable else f"{room} may not include {owners[0]} ({name})"
    library = library_of(name)
    if library is None:
        return None if SYSTEM.match(name) else f"<{name}> is of no library in the table"
    if library in CONFINED and room not in CONFINED[library]:
        return f"<{name}> ({library}) stays in {', '.join(sorted(CONFINED[library]))}"
    if any(library in rooms[folder].libraries for folder in reachable):
        return None
    return f"{room} may not include {library} (<{name}>)"


def check_floors(root):
    rooms = read_table((root / "docs/design.md").read_text(encoding="utf-8"))
    problems = []
    for room in rooms.values():
        if room.is_free:
            continue
        for path in sources(root / room.folder, {".h", ".cpp"}):
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                match = INCLUDE.match(line)
                problem = match and check_include(rooms, room.folder, *match.groups())
                if problem:
                    problems.append(f"{path.relative_to(root)}:{number}: {problem}")
    return problems


def arrows(root):
    """Pairs of folders: a file of the first includes a header of the second. Rooms that may include
    anything (tests, experiments) are left out, as the first and as the second."""
    rooms = read_table((root / "docs/design.md").read_text(encoding="utf-8"))
    found = set()
    for room in (room for room in rooms.values() if not room.is_free):
        for path in sources(root / room.folder, {".h", ".cpp"}):
            here = path.parent.relative_to(root).as_posix()
            for line in path.read_text(encoding="utf-8").splitlines():
                match = INCLUDE.match(line)
                if match and match[1] == '"':
                    found.add((here, match[2].rpartition("/")[0]))
    return found


def circle_in(pairs):
    """Folders on circles of arrows, or on a way from one circle to another; empty without circles."""
    left = {pair for pair in pairs if pair[0] != pair[1]}
    while True:
        ends = {below for _, below in left} & {above for above, _ in left}
        inside = {(above, below) for above, below in left if above in ends and below in ends}
        if inside == left:
            return sorted({name for pair in left for name in pair})
        left = inside


def arrows_up(root, pairs):
    """Arrows to a room that stands further down in the table, that is on a higher floor."""
    floors = list(read_table((root / "docs/design.md").read_text(encoding="utf-8")))
    of = {name: next(i for i, room in enumerate(floors) if f"{name}/".startswith(room + "/"))
          for pair in pairs for name in pair}
    return sorted((above, below) for above, below in pairs if of[above] < of[below])


def count(root):
    pairs = arrows(root)
    between = {(above, below) for above, below in pairs if above != below}
    names = {name for pair in pairs for name in pair}
    lines = [f"{len(names)} rooms, {len(between)} arrows between them, "
             f"{len(arrows_up(root, pairs))} of them up, {len(circle_in(pairs))} rooms in circles"]
    for part in sorted({name.split("/")[0] for name in names}):
        inside = [name for name in names if name.split("/")[0] == part]
        within = [pair for pair in between if pair[0] in inside and pair[1] in inside]
        lines.append(f"{part}: {len(inside)} rooms, {len(within)} arrows between them")
    return lines


def check_style(root):
    rooms = read_table((root / "docs/design.md").read_text(encoding="utf-8"))
    problems = []
    for folder in rooms:
        for path in sources(root / folder, {".h", ".cpp", ".py"}):
            lines = path.read_text(encoding="utf-8").splitlines()
            name = path.relative_to(root)
            if not any("SPDX-License-Identifier: Apache-2.0" in line for line in lines[:3]):
                problems.append(f"{name}:1: has no SPDX line")
            if path.suffix == ".h" and "#pragma once" not in lines:
                problems.append(f"{name}:1: has no #pragma once")
            if len(lines) > MAX_LINES:
                problems.append(f"{name}:{len(lines)}: is longer than {MAX_LINES} lines")
    return sorted(set(problems))


def main():
    root = Path(sys.argv[1])
    if "--count" in sys.argv[2:]:
        print("\n".join(count(root)))
        return 0
    problems = check_floors(root) + check_style(root)
    print("\n".join(problems))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
