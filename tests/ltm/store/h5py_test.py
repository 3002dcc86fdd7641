# SPDX-License-Identifier: Apache-2.0
"""A store of ours opened with plain h5py: the same numbers as our reader gives.

usage: h5py_test.py WRITE_EXAMPLE_STORE
"""

import json
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

ENTITY = "Vision/RGB/head/cam"
PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
writer = ""


class PlainH5py(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory(prefix="engram-h5py-")
        cls.store = Path(cls.scratch.name) / "store"
        done = subprocess.run([writer, cls.store], capture_output=True, text=True, check=True)
        cls.rows = json.loads(done.stdout)
        manifest = json.loads((cls.store / "MANIFEST.json").read_text(encoding="utf-8"))
        files = {segment["kind"]: segment["file"] for segment in manifest["segments"]}
        cls.files = {kind: cls.store / file for kind, file in files.items()}
        cls.recorded = h5py.File(cls.files["recorded"], "r")
        cls.latent = h5py.File(cls.files["latent"], "r")

    @classmethod
    def tearDownClass(cls):
        cls.recorded.close()
        cls.latent.close()
        cls.scratch.cleanup()

    def column(self, kind, path):
        group = self.recorded[ENTITY]["columns"][kind]
        paths = list(group["paths"].asstr())
        return group["values"][:, paths.index(path)]

    def all_rows(self, column):
        """A column per row: one row stands for all where they are equal."""
        return list(column) * (len(self.rows) if len(column) == 1 else 1)

    def expected(self, name):
        return [row[name] for row in self.rows]

    def test_attributes_say_what_the_file_is(self):
        self.assertEqual(self.recorded.attrs["format"].decode(), "engram segment")
        self.assertEqual(self.recorded.attrs["format_version"], 1)
        self.assertEqual(self.recorded.attrs["kind"].decode(), "recorded")
        self.assertEqual(self.latent.attrs["kind"].decode(), "latent")
        self.assertEqual(self.recorded[ENTITY].attrs["memory_id"].decode(), ENTITY)
        self.assertEqual(self.latent[ENTITY].attrs["model_version"], 1)

    def test_timestamps(self):
        for file in (self.recorded, self.latent):
            stamps = file[ENTITY]["timestamp"]
            self.assertEqual(stamps.dtype, np.int64)
            self.assertEqual(list(stamps), self.expected("timestamp"))
            self.assertEqual(self.all_rows(file[ENTITY]["instance"]), [0] * len(self.rows))

    def test_numbers(self):
        self.assertEqual(list(self.column("float64", "joints/a\\/b")), self.expected("a"))
        self.assertEqual(list(self.column("float64", "joints/elbow")), self.expected("elbow"))
        self.assertEqual(list(self.column("int64", "count")), self.expected("count"))
        self.assertEqual([bool(x) for x in self.column("bool", "closed")], self.expected("closed"))
        force = self.recorded[ENTITY]["arrays/force"]
        self.assertEqual(force.dtype, np.float32)
        np.testing.assert_array_equal(force[:], np.array(self.expected("force"), np.float32))

    def test_providers(self):
        metadata = self.recorded[ENTITY]["metadata"]
        names = list(metadata["providers"].asstr())
        providers = self.all_rows(metadata["provider"])
        self.assertEqual([names[i] for i in providers], self.expected("provider"))
        self.assertEqual(self.all_rows(metadata["confidence"]), [0.5] * len(self.rows))

    def test_images_are_png_at_their_offsets(self):
        media = self.recorded[ENTITY]["media/image"]
        self.assertEqual(media.attrs["codec"].decode(), "png")
        self.assertEqual(media.attrs["path"].decode(), "image")
        self.assertEqual(media.attrs["element_type"].decode(), "uint8")
        self.assertEqual(list(media["shape"]), [20, 30, 3])
        offsets = [int(offset) for offset in media["offset"]]
        whole = media["bytes"][:].tobytes()
        start = media["bytes"].id.get_offset()
        raw = self.files["recorded"].read_bytes()
        for row, expected in enumerate(self.rows):
            png = whole[offsets[row]:offsets[row + 1]]
            self.assertEqual(len(png), expected["png_bytes"])
            self.assertEqual(list(png[:24]), expected["png_start"])
            self.assertTrue(png.startswith(PNG_SIGNATURE))
            self.assertEqual(struct.unpack(">II", png[16:24]), (30, 20))
            # The bytes lie in the file as they are.
            self.assertEqual(raw[start + offsets[row]:start + offsets[row + 1]], png)

    def test_types_are_json_beside_the_values(self):
        types = json.loads(self.recorded["#types"].asstr()[0])
        table = types["Vision/RGB/head"]["types"]
        self.assertEqual(table[-1]["name"], "Robot")
        units = {entry.get("unit") for entry in table}
        self.assertTrue({"rad", "N"} <= units)

    def test_latents(self):
        group = self.latent[ENTITY]
        offsets, codes = group["latent/offset"][:], group["latent/bytes"][:]
        holders = group["latent/holder"][:]
        for row, expected in enumerate(self.expected("code")):
            holder = int(holders[row])
            self.assertEqual(list(codes[offsets[holder]:offsets[holder + 1]]), expected)
        self.assertEqual(len(set(holders)), 15 + 5)
        places = [list(place) for place in zip(group["latent/index"], group["latent/count"])]
        self.assertEqual(places, self.expected("place"))
        self.assertEqual(self.all_rows(group["error/image_mse"]), [4.0] * len(self.rows))
        self.assertEqual(self.all_rows(group["error/number_mse"]), [0.5] * len(self.rows))


if __name__ == "__main__":
    writer = sys.argv.pop(1)
    unittest.main()
