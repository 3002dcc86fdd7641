#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Files that h5py made as robomimic, LIBERO and ALOHA do, through Engram and back: h5py finds
every dataset, type and attribute again."""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

PROGRAM = sys.argv.pop(1)


def make_robomimic(path, rate=25):
    random = np.random.default_rng(7)
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        env = {"env_name": "Lift", "type": 1, "env_kwargs": {"robots": "Panda"}}
        if rate:
            env["env_kwargs"]["control_freq"] = rate
        data.attrs["env_args"] = json.dumps(env, indent=4)
        data.attrs["date"] = "2026-11-23"
        data.attrs["repository_version"] = "größe"
        total = 0
        for demo, samples in [(0, 12), (1, 7), (10, 5), (2, 9)]:
            group = data.create_group(f"demo_{demo}")
            group.attrs["num_samples"] = samples
            group.attrs["model_file"] = "<mujoco>" + "x" * 70000 + "</mujoco>"
            group.attrs["init_state"] = random.normal(size=13)
            group.attrs["is_success"] = np.bool_(demo % 2)
            group.attrs["tags"] = ["left", "größe"]
            group.attrs["weight"] = np.float32(0.5)
            group.create_dataset("actions", data=random.normal(size=(samples, 7)))
            group.create_dataset("rewards", data=random.normal(size=samples))
            group.create_dataset("dones", data=random.integers(0, 2, samples))
            group.create_dataset("states", data=random.normal(size=(samples, 32)))
            group.create_dataset("is_expert", data=random.integers(0, 2, (samples, 1)) > 0)
            group.create_dataset("half", data=random.normal(size=(samples, 3)).astype("f2"))
            group.create_dataset("stage", data=random.integers(0, 9, samples).astype("u1"))
            group["action_dict/abs_pos"] = random.normal(size=(samples, 3)).astype("f4")
            for below in ["obs", "next_obs"]:
                obs = group.create_group(below)
                images = random.integers(0, 255, (samples, 16, 20, 3)).astype("u1")
                obs.create_dataset("agentview_image", data=images, compression="gzip")
                obs.create_dataset(
                    "agentview_depth", data=random.random((samples, 16, 20, 1)).astype("f4"),
                    compression="gzip", compression_opts=9)
                obs.create_dataset("robot0_eef_pos", data=random.normal(size=(samples, 3)))
                obs.create_dataset("object", data=random.normal(size=(samples, 10)))
                obs["robot0_eef_pos"].attrs["unit"] = "m"
            group["obs"].attrs["comment"] = "seen"
            total += samples
        data.attrs["total"] = total
        file["mask/train"] = np.array(["demo_0", "demo_10"], dtype="S")
        file["mask/valid"] = np.array(["demo_1", "demo_2"], dtype="S")


def smooth_images(samples):
    t, y, x = np.meshgrid(np.arange(samples), np.arange(32), np.arange(48), indexing="ij")
    return np.stack([4 * x + t, 6 * y, 100 + x + y], axis=-1).astype("u1")


def make_aloha(path, samples, seed=3):
    random = np.random.default_rng(seed)
    with h5py.File(path, "w", rdcc_nbytes=1024**2 * 2) as root:
        root.attrs["sim"] = True
        obs = root.create_group("observations")
        images = obs.create_group("images")
        for camera in ["top", "cam_left_wrist"]:
            rows = random.integers(0, 255, (samples, 12, 16, 3)).astype("u1")
            images.create_dataset(
                camera, (samples, 12, 16, 3), dtype="uint8", chunks=(1, 12, 16, 3))[...] = rows
        for name in ["qpos", "qvel", "effort"]:
            obs.create_dataset(name, (samples, 14))[...] = random.normal(size=(samples, 14))
        root.create_dataset("action", (samples, 14))[...] = random.normal(size=(samples, 14))
        root.create_dataset("base_action", (samples, 2))[...] = random.normal(size=(samples, 2))


class RoundTrip(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="engram-hdf5-")
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)

    def run_program(self, name, source, target, *options):
        store = self.folder / f"{target.name} store"
        result = subprocess.run([PROGRAM, name, source, store, target, *options],
                                capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout

    def same_attributes(self, a, b, where):
        self.assertEqual(set(a.attrs), set(b.attrs), where)
        for name in a.attrs:
            one, other = a.attrs[name], b.attrs[name]
            self.assertEqual(type(one), type(other), f"{where}@{name}")
            if isinstance(one, np.ndarray):
                self.assertEqual(one.dtype, other.dtype, f"{where}@{name}")
            np.testing.assert_array_equal(one, other, f"{where}@{name}")

    def same(self, a, b, where=""):
        self.same_attributes(a, b, where)
        if isinstance(a, h5py.Group):
            self.assertEqual(list(a), list(b), where)
            for name in a:
                self.same(a[name], b[name], f"{where}/{name}")
            return
        self.assertEqual(a.dtype, b.dtype, where)
        self.assertEqual(a.shape, b.shape, where)
        self.assertEqual((a.compression, a.compression_opts), (b.compression, b.compression_opts),
                         where)
        np.testing.assert_array_equal(a[...], b[...], where)

    def same_files(self, a, b):
        with h5py.File(a) as one, h5py.File(b) as other:
            self.same(one, other)

    def test_robomimic(self):
        make_robomimic(self.folder / "in.hdf5")
        told = self.run_program("robomimic", self.folder / "in.hdf5", self.folder / "out.hdf5")
        self.assertEqual(told, "damaged: 0\n")
        self.same_files(self.folder / "in.hdf5", self.folder / "out.hdf5")
        self.run_program("robomimic", self.folder / "out.hdf5", self.folder / "again.hdf5")
        self.same_files(self.folder / "in.hdf5", self.folder / "again.hdf5")

    def test_robomimic_without_rate(self):
        make_robomimic(self.folder / "in.hdf5", rate=None)
        told = self.run_program("robomimic", self.folder / "in.hdf5", self.folder / "out.hdf5")
        self.assertIn("no rate in the file, 20 Hz assumed: 1\n", told)
        self.same_files(self.folder / "in.hdf5", self.folder / "out.hdf5")

    def test_newest_layout_of_h5py(self):
        with h5py.File(self.folder / "in.hdf5", "w", libver="latest") as file:
            group = file.create_group("data/demo_0")
            for i in range(6):
                group.attrs[f"text {i}"] = f"größe {i}"
            group["actions"] = np.ones((4, 2), ">f4")
            group.attrs["num_samples"] = 4
            file["data"].attrs["env_args"] = "{}"
            file["data"].attrs["total"] = 4
        self.run_program("robomimic", self.folder / "in.hdf5", self.folder / "out.hdf5")
        with h5py.File(self.folder / "out.hdf5") as file:
            self.assertEqual(file["data/demo_0"].attrs["text 5"], "größe 5")
            np.testing.assert_array_equal(file["data/demo_0/actions"][...], np.ones((4, 2)))

    def test_what_is_not_read_is_reported(self):
        make_robomimic(self.folder / "other.hdf5")
        make_robomimic(self.folder / "in.hdf5")
        with h5py.File(self.folder / "in.hdf5", "a") as file:
            demo = file["data/demo_1"]
            demo["outside"] = h5py.ExternalLink(str(self.folder / "other.hdf5"), "/data/demo_0")
            demo["nowhere"] = h5py.SoftLink("/nothing")
            demo["single"] = 5
            demo["empty"] = np.zeros((0, 3))
            demo["pairs"] = np.zeros(7, [("a", "f4"), ("b", "i4")])
            demo.attrs["reference"] = file["mask"].ref
            file["extra/array"] = [1, 2]
        told = self.run_program("robomimic", self.folder / "in.hdf5", self.folder / "out.hdf5")
        self.assertEqual(told.splitlines(), [
            "not carried: arrays of elements that are no numbers or texts: 1",
            "not carried: arrays without rows: 2",
            "not carried: attributes that cannot be read: 1",
            "not carried: groups beside data and mask: 1",
            "not carried: links that lead nowhere: 2",
            "damaged: 0"])

    def test_damaged_rows_are_counted_and_missing(self):
        with h5py.File(self.folder / "in.hdf5", "w") as file:
            file["data/demo_0/actions"] = np.arange(8.0)
            rows = file.create_dataset("data/demo_0/obs/pos", data=np.arange(8.0), chunks=(2,),
                                       compression="gzip")
            place = rows.id.get_chunk_info(1)
        content = bytearray((self.folder / "in.hdf5").read_bytes())
        content[place.byte_offset] ^= 0xFF
        (self.folder / "in.hdf5").write_bytes(content)
        told = self.run_program("robomimic", self.folder / "in.hdf5", self.folder / "out.hdf5")
        self.assertIn("damaged: 2\n", told)

    def test_aloha_episode(self):
        make_aloha(self.folder / "episode_0.hdf5", 8)
        told = self.run_program("aloha", self.folder / "episode_0.hdf5", self.folder / "out.hdf5")
        self.assertEqual(told, "damaged: 0\n")
        self.same_files(self.folder / "episode_0.hdf5", self.folder / "out.hdf5")

    def test_aloha_with_compressed_images(self):
        make_aloha(self.folder / "episode_0.hdf5", 5)
        images = smooth_images(5)
        with h5py.File(self.folder / "episode_0.hdf5", "a") as file:
            del file["observations/images"]
            file["observations/images/top"] = images
            file["observations/images/wrist"] = images[:, ::2]
        self.run_program("aloha", self.folder / "episode_0.hdf5", self.folder / "jpeg.hdf5", "95")
        with h5py.File(self.folder / "jpeg.hdf5") as file:
            self.assertTrue(file.attrs["compress"])
            self.assertEqual(file["compress_len"].shape, (2, 5))
            self.assertEqual(file["compress_len"].dtype, np.float32)
            for camera, sizes in zip(["top", "wrist"], file["compress_len"][...].astype(int)):
                rows = file["observations/images"][camera]
                self.assertEqual(rows.shape, (5, max(sizes)))
                for row, size in zip(rows, sizes):
                    self.assertEqual(bytes(row[:2]) + bytes(row[size - 2:size]), b"\xff\xd8\xff\xd9")
                    self.assertFalse(row[size:].any())
        told = self.run_program("aloha", self.folder / "jpeg.hdf5", self.folder / "plain.hdf5")
        self.assertEqual(told, "damaged: 0\n")
        with h5py.File(self.folder / "plain.hdf5") as file:
            self.assertFalse(file.attrs["compress"])
            found = file["observations/images/top"][...]
            self.assertEqual(found.shape, images.shape)
            self.assertLess(np.abs(found.astype(int) - images).mean(), 4)
            self.assertNotIn("compress_len", file)

    def test_images_of_variable_length(self):
        make_aloha(self.folder / "episode_0.hdf5", 5)
        with h5py.File(self.folder / "episode_0.hdf5", "a") as file:
            del file["observations/images"]
            file["observations/images/top"] = smooth_images(5)
        self.run_program("aloha", self.folder / "episode_0.hdf5", self.folder / "jpeg.hdf5", "95")
        with h5py.File(self.folder / "jpeg.hdf5", "a") as file:
            rows = file["observations/images/top"][...]
            del file["observations/images/top"]
            images = file.create_dataset("observations/images/top", (5,),
                                         dtype=h5py.vlen_dtype(np.uint8))
            for i, row in enumerate(rows):
                images[i] = np.trim_zeros(row, "b")
            images[3] = np.zeros(9, "u1")
        told = self.run_program("aloha", self.folder / "jpeg.hdf5", self.folder / "plain.hdf5")
        self.assertIn("damaged: 1\n", told)
        self.assertIn("do not come one per step: 1\n", told)

    def test_aloha_folder(self):
        source = self.folder / "in"
        source.mkdir()
        for i, samples in [(0, 8), (1, 5), (10, 3)]:
            make_aloha(source / f"episode_{i}.hdf5", samples, seed=i)
        self.run_program("aloha", source, self.folder / "out")
        for file in source.iterdir():
            self.same_files(file, self.folder / "out" / file.name)
        self.assertEqual(len(list((self.folder / "out").iterdir())), 3)


if __name__ == "__main__":
    unittest.main()
