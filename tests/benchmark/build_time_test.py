#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The arithmetic of build_time.py, on a log that was made up."""

import json
import sys
import unittest

import build_time
import note_time

JOURNAL = "ltm/store/CMakeFiles/engram_store.dir/journal.cpp.o"
LOG = f"""# ninja log v5
0\t900\t0\t{JOURNAL}\taaaa
0\t5000\t0\tcmake/x.dir/cmake_pch.hxx.gch\tbbbb
1000\t3000\t0\t{JOURNAL}\taaaa
3000\t3250\t0\tltm/store/libengram_store.a\tcccc
3300\t3400\t0\tserver/wire/engram/v1/names.pb.h\tdddd
3300\t3400\t0\tserver/wire/engram/v1/names.pb.cc\tdddd
3400\t6400\t0\tcli/CMakeFiles/engram.dir/main.cpp.o\teeee
6400\t7400\t0\tbin/engram\tffff
"""


def note(output, source, user_s, system_s=0.0):
    return json.dumps({"output": output, "source": source, "user_s": user_s, "system_s": system_s,
                       "wall_s": 99.0}) + "\n"


NOTES = (note(JOURNAL, "ltm/store/journal.cpp", 9.0)
         + note(JOURNAL, "ltm/store/journal.cpp", 1.5, 0.25)
         + note("cmake/x.dir/cmake_pch.hxx.gch", "cmake/x.dir/cmake_pch.hxx", 2.0)
         + note("cli/CMakeFiles/engram.dir/main.cpp.o", "cli/main.cpp", 2.0)
         + note("bin/engram", "", 0.5))


class BuildTimeTest(unittest.TestCase):
    def setUp(self):
        self.steps = build_time.steps_of_log(LOG)

    def test_the_last_run_of_a_step_counts_and_one_of_two_outputs_counts_once(self):
        self.assertEqual(len(self.steps), 6)
        walls = {step.output: step.wall_s for step in self.steps}
        self.assertEqual(walls[JOURNAL], 2.0)
        self.assertAlmostEqual(sum(walls.values()), 2.0 + 5.0 + 0.25 + 0.1 + 3.0 + 1.0)

    def test_a_log_alone_gives_its_own_times(self):
        report = build_time.report_of(self.steps, None, 20)
        self.assertFalse(report["is_measured"])
        self.assertAlmostEqual(report["total_s"], 11.35)
        self.assertIn("count too much", build_time.text_of(report))

    def test_what_was_noted_replaces_the_times_of_the_log(self):
        build_time.add_notes(self.steps, NOTES)
        total = {"user_s": 6.0, "system_s": 0.75, "wall_s": 7.5}
        report = build_time.report_of(self.steps, total, 1)
        self.assertEqual(report["total_s"], 6.75)
        self.assertEqual(report["wall_s"], 7.5)
        self.assertAlmostEqual(report["unmeasured_s"], 0.35)
        self.assertEqual({one["room"]: round(one["seconds"], 6) for one in report["rooms"]},
                         {"ltm/store": 1.75, "(precompiled headers)": 2.0, "cli": 2.0,
                          "(linked)": 0.5, "(other steps)": 0.35})
        self.assertEqual(len(report["dearest"]), 1)
        self.assertEqual(report["dearest"][0]["seconds"], 2.0)
        self.assertIn("cli", build_time.text_of(report))

    def test_sources_that_are_compiled_together_count_for_their_room(self):
        for output, room in (("ltm/store/CMakeFiles/engram_store.dir/Unity/unity_0_cxx.cxx.o",
                              "ltm/store"),
                             ("cli/CMakeFiles/engram_program.dir/Unity/unity_1_cxx.cxx.o", "cli")):
            step = build_time.Step(output, 1.0, 1.0, "build/bench/x/Unity/unity_0_cxx.cxx")
            self.assertEqual(build_time.room_of(step), room)

    def test_a_command_is_measured_and_named(self):
        code, used = note_time.run([sys.executable, "-c", "sum(range(3_000_000)); exit(3)"])
        self.assertEqual(code, 3)
        self.assertGreater(used["user_s"], 0)
        self.assertLessEqual(used["user_s"], used["wall_s"] + 0.1)
        command = ["g++", "-O3", "-o", "a/b.cpp.o", "-c", "/src/a/b.cpp"]
        noted = note_time.note_of(command, "/src/build/bench", "/src", used)
        self.assertEqual((noted["output"], noted["source"]), ("a/b.cpp.o", "a/b.cpp"))
        self.assertEqual(note_time.note_of(["g++", "-o", "x"], "/b", "/s", {})["source"], "")


if __name__ == "__main__":
    unittest.main()
