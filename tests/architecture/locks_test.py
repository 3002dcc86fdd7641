# SPDX-License-Identifier: Apache-2.0
"""Every mutex is one that clang checks, and says what it guards. `make check-locks` does the rest."""

import re
import shutil
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from check_locks import (COMPILER, MUTEX, ROOMS, ROOT, arguments_for, check,  # noqa: E402
                         sees_mutex)

#: Where the standard library's may stand, and why.
BARE = {
    MUTEX: "wraps them",
    "training/fit/fit_state.cpp": "the mutex is LibTorch's, of its random numbers",
}
_BARE = re.compile(r"\bstd::(?:(?:recursive_|timed_|shared_|recursive_timed_|shared_timed_)?mutex"
                   r"|lock_guard|unique_lock|scoped_lock|shared_lock|condition_variable(?:_any)?)\b"
                   r"|\bpthread_(?:mutex|rwlock|cond|spin)\w*")
_MUTEX = re.compile(r"^\s*(?:static |mutable )*(?:Mutex|SharedMutex) (\w+)\b[^;(]*(?:\([^;]*\))?;"
                    r"[ \t]*(//.*)?$", re.MULTILINE)
_COMMENT = re.compile(r"//.*")


def bare_locks(text: str) -> list[str]:
    """Locks of the standard library or of POSIX that a source names."""
    return [found.group() for found in _BARE.finditer(_COMMENT.sub("", text))]


def unexplained(text: str) -> list[str]:
    """Mutexes of a source that guard no member by name and have no comment."""
    lines = text.split("\n")
    silent = []
    for found in _MUTEX.finditer(text):
        name, comment = found.groups()
        above = lines[text[:found.start(1)].count("\n") - 1].strip()
        guards = re.search(rf"GUARDED_BY\((?:\w+(?:\.|->))?{name}\)", text)
        if not guards and not comment and not above.startswith("//"):
            silent.append(name)
    return silent


def sources() -> list[Path]:
    return [path for room in ROOMS for path in sorted((ROOT / room).rglob("*"))
            if path.suffix in (".h", ".cpp")]


class Locks(unittest.TestCase):
    def test_every_lock_is_one_that_clang_checks(self) -> None:
        for path in sources():
            name = str(path.relative_to(ROOT))
            if name not in BARE:
                with self.subTest(name):
                    self.assertEqual(bare_locks(path.read_text(encoding="utf-8")), [])

    def test_every_mutex_says_what_it_guards(self) -> None:
        mutexes = 0
        for path in sources():
            text = path.read_text(encoding="utf-8")
            if str(path.relative_to(ROOT)) == MUTEX:
                continue
            mutexes += len(_MUTEX.findall(text))
            with self.subTest(str(path.relative_to(ROOT))):
                self.assertEqual(unexplained(text), [])
        self.assertGreater(mutexes, 30, "the expression finds mutexes")

    def test_what_may_be_bare_is_there(self) -> None:
        for name in BARE:
            self.assertTrue(bare_locks((ROOT / name).read_text(encoding="utf-8")), name)


class Search(unittest.TestCase):
    def test_finds_bare_locks(self) -> None:
        self.assertEqual(bare_locks("  std::recursive_mutex m;\n"), ["std::recursive_mutex"])
        self.assertEqual(bare_locks("std::unique_lock lock(m);"), ["std::unique_lock"])
        self.assertEqual(bare_locks("pthread_mutex_init(&m, nullptr);"), ["pthread_mutex_init"])
        self.assertEqual(bare_locks("Mutex m;  // Not a std::mutex.\n"), [])

    def test_finds_mutexes_that_say_nothing(self) -> None:
        self.assertEqual(unexplained("  Mutex mutex_;\n  int count_;\n"), ["mutex_"])
        self.assertEqual(unexplained("  mutable SharedMutex mutex_;\n"), ["mutex_"])
        self.assertEqual(unexplained("  Mutex a ENGRAM_ACQUIRED_BEFORE(b);\n"), ["a"])
        self.assertEqual(unexplained("  Mutex mutex_;\n  int n ENGRAM_GUARDED_BY(mutex_);\n"), [])
        self.assertEqual(unexplained("  Mutex mutex_;  ///< One at a time.\n"), [])
        self.assertEqual(unexplained("  /// One at a time.\n  Mutex mutex_;\n"), [])


class Check(unittest.TestCase):
    def test_leaves_out_what_only_gcc_reads(self) -> None:
        arguments = arguments_for("/usr/bin/c++ -DA -Werror -Winvalid-pch -include /b/cmake_pch.hxx"
                                  " -std=gnu++20 -o a.o -c /s/a.cpp")
        self.assertEqual(arguments[1:4], ["-DA", "-std=gnu++20", "/s/a.cpp"])
        self.assertIn("-Werror=thread-safety", arguments)

    def test_finds_mutexes_behind_other_headers(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            (root / "ltm/core").mkdir(parents=True)
            (root / MUTEX).write_text("")
            (root / "ltm/a.h").write_text(f'#include "{MUTEX}"\n#include "ltm/a.h"\n')
            (root / "ltm/a.cpp").write_text('#include "ltm/a.h"\n')
            (root / "ltm/b.cpp").write_text("#include <mutex>\n")
            self.assertTrue(sees_mutex(root / "ltm/a.cpp", root, {}))
            self.assertFalse(sees_mutex(root / "ltm/b.cpp", root, {}))


#: A class that uses what its mutex guards, and in what a test puts there.
_COUNTED = """
#include "ltm/core/mutex.h"
class Counted {{
 public:
  void wait() {{
    const engram::MutexLock lock(mutex_);
    changed_.wait(mutex_, [this]() ENGRAM_REQUIRES(mutex_) {{ return count_ > 0; }});
  }}
  void add() {{ {body} }}
 private:
  void add_locked() ENGRAM_REQUIRES(mutex_) {{ ++count_; }}
  engram::Mutex first_ ENGRAM_ACQUIRED_BEFORE(mutex_);
  engram::Mutex mutex_;
  engram::ConditionVariable changed_;
  int count_ ENGRAM_GUARDED_BY(mutex_) = 0;
}};
"""
_LOCK = "const engram::MutexLock lock(mutex_);"
_LOCK_FIRST = "const engram::MutexLock first(first_);"


@unittest.skipUnless(shutil.which(COMPILER), "clang is not installed: make check-locks does it")
class Analysis(unittest.TestCase):
    def errors(self, body: str) -> str:
        with tempfile.TemporaryDirectory() as folder:
            source = Path(folder) / "counted.cpp"
            source.write_text(_COUNTED.format(body=body), encoding="utf-8")
            is_good, said = check((folder, arguments_for(
                f"c++ -std=gnu++20 -I{ROOT} -o counted.o -c {source}")))
        self.assertEqual(is_good, not said)
        return said

    def test_accepts_what_holds_the_lock(self) -> None:
        self.assertEqual(self.errors(f"{_LOCK} ++count_;"), "")
        self.assertEqual(self.errors(f"{_LOCK_FIRST} {_LOCK} add_locked();"), "")

    def test_refuses_what_does_not(self) -> None:
        self.assertIn("requires holding mutex 'mutex_'", self.errors("++count_;"))
        self.assertIn("requires holding mutex 'mutex_'", self.errors("add_locked();"))
        self.assertIn("requires holding mutex 'mutex_'",
                      self.errors("changed_.wait(mutex_, [] { return true; });"))

    def test_refuses_locks_taken_twice_or_in_another_order(self) -> None:
        self.assertIn("already held", self.errors(f"{_LOCK} {_LOCK.replace('lock(', 'again(')}"))
        self.assertIn("must be acquired before", self.errors(f"{_LOCK} {_LOCK_FIRST}"))


if __name__ == "__main__":
    unittest.main()
