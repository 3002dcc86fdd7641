# SPDX-License-Identifier: Apache-2.0
"""Programs are run, measured, watched and stopped."""

import os
import signal
import sys
import threading
import time

import numpy as np
import pytest

from experiments.month import program


def python(text, **more):
    return program.run([sys.executable, "-c", text], **more)


def test_a_program_tells_what_it_wrote_and_how_it_ended():
    ended = python("import sys; print('out'); print('err', file=sys.stderr); sys.exit(3)")
    assert (ended.code, ended.out, ended.err) == (3, "out\n", "err\n")
    with pytest.raises(program.Failed, match="it ended with 3: err"):
        program.needs(ended, "it")
    assert program.needs(ended, "it", 0, 3) is ended


def test_processor_time_and_memory_are_those_of_the_program_alone():
    ours = np.ones(40_000_000)  # 320 MB, which wait4() counts.
    ended = python("import time; time.sleep(0.2)")
    assert ended.processor_seconds < 5 and 1 < ended.megabytes < 100
    ended = python("import time; some = b'x' * 150_000_000; time.sleep(0.2)")
    assert 150 < ended.megabytes < 250
    assert ours.sum() > 0


def test_a_program_is_killed_by_what_watches_its_lines():
    ended = python("import sys, time; print('go', file=sys.stderr, flush=True); time.sleep(60)",
                   watch=lambda line, pid: os.kill(pid, signal.SIGKILL))
    assert ended.code == -signal.SIGKILL


def test_what_runs_is_stopped_and_nothing_new_begins():
    ended, begin = [], time.monotonic()
    runs = threading.Thread(target=lambda: ended.append(python("import time; time.sleep(60)")))
    runs.start()
    while not program._running:
        time.sleep(0.01)
    program.stop_all()
    try:
        runs.join()
        assert ended[0].code == -signal.SIGTERM and time.monotonic() - begin < 30
        with pytest.raises(program.Failed, match="was not started"):
            python("pass")
    finally:
        program.start_again()
    assert python("pass").code == 0 and not program._running
