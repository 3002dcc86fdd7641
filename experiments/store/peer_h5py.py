# SPDX-License-Identifier: Apache-2.0
"""Writes a stream to one HDF5 file with plain h5py and gzip, reads images back and times both.

Usage: peer_h5py.py STREAM_FOLDER FILE REPORT
Writes seconds of writing until closed, and the seconds of each read, to REPORT as JSON.
"""

import json
import pathlib
import sys
import time

import h5py
import numpy as np

IMAGE = (480, 640, 3)
CAMERAS = ("left", "right")


class Sensor:
    """A dataset that grows by one row per message, and the times of its rows."""

    def __init__(self, file, name, shape, dtype, rows_per_chunk):
        options = dict(maxshape=(None, *shape), chunks=(rows_per_chunk, *shape), compression="gzip")
        self.values = file.create_dataset(f"{name}/values", (0, *shape), dtype, **options)
        self.times = file.create_dataset(
            f"{name}/times", (0,), "i8", maxshape=(None,), chunks=(1024,), compression="gzip")
        self.count = 0

    def append(self, stamp, value):
        self.values.resize(self.count + 1, axis=0)
        self.times.resize(self.count + 1, axis=0)
        self.values[self.count] = value
        self.times[self.count] = stamp
        self.count += 1


def messages_of(tick, frames):
    """(sensor, value) of one tick, each in the form that h5py takes."""
    yield "positions", np.array(tick["positions"])
    yield "velocities", np.array(tick["velocities"])
    for camera, frame in zip(CAMERAS, tick.get("images", [])):
        yield camera, frames[frame]
    for name, matrix in tick.get("poses", {}).items():
        yield "pose_" + name, np.array(matrix, "f4").reshape(4, 4)
    if tick["text"]:
        yield "text", tick["text"]


def make_sensor(file, name, value):
    if name == "text":
        return Sensor(file, name, (), h5py.string_dtype(), 64)
    return Sensor(file, name, value.shape, value.dtype, 1 if name in CAMERAS else 100)


def write(path, ticks, frames):
    """Seconds and processor seconds that h5py took, until the file was closed."""
    wall = cpu = 0.0
    sensors = {}
    file = h5py.File(path, "w")
    for tick in ticks:
        messages = list(messages_of(tick, frames))
        start, cpu_start = time.perf_counter(), time.process_time()
        for name, value in messages:
            if name not in sensors:
                sensors[name] = make_sensor(file, name, value)
            sensors[name].append(tick["time"], value)
        wall += time.perf_counter() - start
        cpu += time.process_time() - cpu_start
    start, cpu_start = time.perf_counter(), time.process_time()
    file.close()
    return wall + time.perf_counter() - start, cpu + time.process_time() - cpu_start


def read(path, stream, frames):
    """Seconds of each read, the search for its time included. Exits where an image differs."""
    seconds = []
    with h5py.File(path, "r") as file:
        values = [file[camera]["values"] for camera in CAMERAS]
        times = [file[camera]["times"][:] for camera in CAMERAS]
        for camera, index in stream["reads"]:
            tick = stream["ticks"][index]
            start = time.perf_counter()
            row = np.searchsorted(times[camera], tick["time"])
            image = values[camera][row]
            seconds.append(time.perf_counter() - start)
            if not np.array_equal(image, frames[tick["images"][camera]]):
                sys.exit(f"h5py: image of camera {camera} at {tick['time']} is not what was there")
    return seconds


def main():
    folder, path, report = map(pathlib.Path, sys.argv[1:])
    stream = json.loads((folder / "stream.json").read_text())
    frames = np.fromfile(folder / "frames", np.uint8).reshape(stream["frames"], *IMAGE)
    wall, cpu = write(path, stream["ticks"], frames)
    seconds = read(path, stream, frames)
    report.write_text(json.dumps(
        {"write_seconds": wall, "write_cpu_seconds": cpu, "read_seconds": seconds}))


if __name__ == "__main__":
    main()
