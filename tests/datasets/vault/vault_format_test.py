# SPDX-License-Identifier: Apache-2.0
"""Reads the golden vault by docs/vault.md alone, with nothing of Engram: what the page says is enough."""

from __future__ import annotations

import ctypes
import ctypes.util
import hashlib
import pathlib
import struct
import unittest

GOLDEN = pathlib.Path(__file__).resolve().parents[2] / "golden" / "vault" / "format_1"
CHUNK, SEAL = 65536, 16
SET_TAG = 0x11  # EVP_CTRL_AEAD_SET_TAG of OpenSSL's evp.h
DAY_NS = 86_400_000_000_000

_CRYPTO = ctypes.CDLL(ctypes.util.find_library("crypto"))
_CRYPTO.EVP_aes_256_gcm.restype = ctypes.c_void_p
_CRYPTO.EVP_CIPHER_CTX_new.restype = ctypes.c_void_p


def decrypted(key: bytes, nonce: bytes, bound: bytes, sealed: bytes) -> bytes:
    """The plain bytes of a chunk. Raises ValueError if its seal does not fit."""
    context = ctypes.c_void_p(_CRYPTO.EVP_CIPHER_CTX_new())
    cipher = ctypes.c_void_p(_CRYPTO.EVP_aes_256_gcm())
    content, seal = sealed[:-SEAL], sealed[-SEAL:]
    plain, count = ctypes.create_string_buffer(len(content) + 16), ctypes.c_int()
    try:
        fits = (_CRYPTO.EVP_DecryptInit_ex(context, cipher, None, key, nonce) == 1
                and _CRYPTO.EVP_DecryptUpdate(context, None, ctypes.byref(count), bound,
                                              len(bound)) == 1
                and _CRYPTO.EVP_DecryptUpdate(context, plain, ctypes.byref(count), content,
                                              len(content)) == 1
                and _CRYPTO.EVP_CIPHER_CTX_ctrl(context, SET_TAG, SEAL, seal) == 1
                and _CRYPTO.EVP_DecryptFinal_ex(context, ctypes.create_string_buffer(16),
                                                ctypes.byref(count)) == 1)
    finally:
        _CRYPTO.EVP_CIPHER_CTX_free(context)
    if not fits:
        raise ValueError("a seal does not fit")
    return plain.raw[:len(content)]


def opened(path: pathlib.Path, key: bytes) -> bytes:
    """The plain bytes of a file of a day."""
    whole = path.read_bytes()
    header, rest = whole[:32], whole[32:]
    magic, version, chunk, identity = struct.unpack("<8sII16s", header)
    assert (magic, version, chunk) == (b"ENGRAMVD", 1, CHUNK)
    assert identity.hex() == path.name
    chunks = [rest[at:at + CHUNK + SEAL] for at in range(0, len(rest), CHUNK + SEAL)]
    plain = b""
    for number, sealed in enumerate(chunks):
        nonce = struct.pack("<QI", number, 1 if number + 1 == len(chunks) else 0)
        plain += decrypted(key, nonce, header + nonce, sealed)
    return plain


def records(plain: bytes) -> list[tuple[int, bytes]]:
    found, at = [], 0
    while at < len(plain):
        kind, size = struct.unpack_from("<BQ", plain, at)
        found.append((kind, plain[at + 9:at + 9 + size]))
        at += 9 + size
    return found


class Fields:
    """Reads the fields of a key file one after the other."""

    def __init__(self, whole: bytes) -> None:
        self.whole, self.at = whole, 0

    def take(self, count: int) -> bytes:
        self.at += count
        return self.whole[self.at - count:self.at]

    def numbers(self, form: str) -> tuple[int, ...]:
        return struct.unpack("<" + form, self.take(struct.calcsize("<" + form)))

    def sized(self) -> bytes:
        return self.take(self.numbers("I")[0])


class KeyFile:
    def __init__(self, whole: bytes) -> None:
        assert hashlib.sha256(whole[:-32]).digest() == whole[-32:]
        fields = Fields(whole[:-32])
        assert fields.take(8) == b"ENGRAMVK" and fields.numbers("I") == (1,)
        self.vault, self.store, self.types = fields.take(16), fields.sized(), fields.sized()
        self.days, self.destroyed = {}, {}
        for _ in range(fields.numbers("Q")[0]):
            entity = fields.sized().decode()
            for _ in range(fields.numbers("Q")[0]):
                day, file, key = fields.numbers("i")[0], fields.take(16), fields.take(32)
                self.days[entity, day] = (file, key, fields.numbers("8Q"), fields.numbers("2q"))
        for _ in range(fields.numbers("Q")[0]):
            entity = fields.sized().decode()
            for _ in range(fields.numbers("Q")[0]):
                day = fields.numbers("i")[0]
                self.destroyed[entity, day] = (fields.take(16), fields.numbers("q")[0])
        self.obsolete = [fields.take(16) for _ in range(fields.numbers("Q")[0])]
        assert fields.at == len(fields.whole)


class VaultFormat(unittest.TestCase):
    def setUp(self) -> None:
        self.keys = KeyFile((GOLDEN / "robot.keys").read_bytes())

    def test_the_vault_and_its_keys_have_one_identity(self) -> None:
        self.assertEqual((GOLDEN / "robot.vault" / "engram.vault").read_bytes(),
                         b"ENGRAMVM" + struct.pack("<I", 1) + self.keys.vault)

    def test_days_are_listed(self) -> None:
        self.assertEqual(len(self.keys.days), 8)
        (gone,) = self.keys.destroyed
        self.assertEqual(gone, ("Vision/RGB/head/cam", 18000))
        self.assertIn(b"label", self.keys.types)

    def test_files_are_decrypted_and_hold_what_is_said(self) -> None:
        for (entity, day), (file, key, numbers, (first, last)) in self.keys.days.items():
            path = GOLDEN / "robot.vault" / file.hex()
            snapshots, _, _, file_bytes = numbers[:4]
            self.assertEqual(path.stat().st_size, file_bytes)
            self.assertEqual((first // DAY_NS, last // DAY_NS), (day, day))
            found = records(opened(path, key))
            self.assertEqual([kind for kind, _ in found], [3] * snapshots + [4])
            self.assertEqual(struct.unpack("<Q", found[-1][1]), (snapshots,))
            for _, payload in found[:-1]:
                uses, note = struct.unpack_from("<II", payload)
                self.assertEqual((uses, note), (0, 0))
                # The frame begins at a multiple of 8, and has the name of its entity.
                self.assertIn(entity.split("/")[0].encode(), payload[8:])

    def test_a_flipped_bit_is_found(self) -> None:
        file, key, *_ = next(iter(self.keys.days.values()))
        whole = bytearray((GOLDEN / "robot.vault" / file.hex()).read_bytes())
        whole[40] ^= 1
        with self.assertRaises(ValueError):
            nonce = struct.pack("<QI", 0, 1)
            decrypted(key, nonce, bytes(whole[:32]) + nonce, bytes(whole[32:]))


if __name__ == "__main__":
    unittest.main()
