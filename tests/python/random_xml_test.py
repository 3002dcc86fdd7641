# SPDX-License-Identifier: Apache-2.0
"""Classes generated from made-up type descriptions.

random_xml_test.py GENERATE_MAIN
"""

import importlib
import keyword
import random
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from engram import idf
from engram.idf.types import PIXELS, POINT_FIELDS
from engram.idf.value import ELEMENT_NAMES

FILES = 40
KEYS = (
    keyword.kwlist
    + "list dict tuple int float str bool range np NDArray field idf enum cache self cls name value"
    " mro real to_idf from_idf idf_type _idf_attributes staticmethod _ __ _x_ __x __init__ __eq__"
    " __slots__ x y z Mode0 Part0 Part1 class_ class__ dataclass annotations object type".split()
)
TEXTS = ["", "A text.", 'say "hi"', '"""', "\\", "'", "ü\n  two lines", "a " * 80, "%s {x} $y #z"]


class RandomXml:
    """Type descriptions of every kind, the same for the same seed."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.names = []

    def chance(self, of):
        return self.random.randrange(of) == 0

    def doc(self):
        # Line breaks inside an attribute would become spaces.
        text = self.random.choice(TEXTS).replace("\n", " ")
        return f" doc={quoteattr(text)}" if text and self.chance(3) else ""

    def size(self):
        return self.random.choice([-1, -1, 0, 1, 3])

    def quantity(self):
        made = self.random.choice(["", ' unit="m"', ' unit="N/m²"'])
        made += self.random.choice(["", ' min="0.1"', ' min="3"', ' min="-2.5"'])
        return made + self.random.choice(["", ' max="7"', ' max="100.5"'])

    def type(self, depth):
        optional = ' optional="true"' if self.chance(4) else ""
        name, attributes, inside = self.kind(depth)
        return f"<{name}{attributes}{optional}{self.doc()}>{inside}</{name}>"

    def kind(self, depth):
        pick = self.random.choice
        element = f' type="{pick(ELEMENT_NAMES)}"'
        real = f' type="{pick(["float32", "float64"])}"'
        kinds = [
            lambda: (pick(["Int", "Long", "Float", "Double"]), self.quantity(), ""),
            lambda: (pick(["String", "Bool", "Time", "MemoryLink"]), "", ""),
            lambda: (pick(["Quaternion", "Orientation", "Pose", "Position"]), real, ""),
            lambda: ("NDArray", f'{element} shape="{self.size()}, 2"' + self.quantity(), ""),
            lambda: (
                "Matrix",
                f'{element} rows="{self.size()}" cols="{self.size()}"' + self.quantity(),
                "",
            ),
            lambda: ("Image", f' pixelType="{pick(list(PIXELS))}" height="{self.size()}"', ""),
            lambda: ("PointCloud", f' type="{pick(list(POINT_FIELDS))}"', ""),
        ]
        if self.names:
            kinds.append(lambda: (pick(self.names), "", ""))
        if depth > 0:
            kinds += [
                lambda: ("List", f' size="{self.size()}"', self.type(depth - 1)),
                lambda: ("Dict", "", self.type(depth - 1)),
                lambda: ("Pair", "", self.type(depth - 1) + self.type(depth - 1)),
                lambda: ("Tuple", "", self.type(depth - 1)),
            ]
        return pick(kinds)()

    def comment(self):
        text = self.random.choice(TEXTS)
        return f"<!-- {text} -->" if text else ""

    def file(self):
        parts = []
        for i in range(2):
            values = ""
            for n, key in enumerate(self.random.sample(KEYS, 6)):
                value = self.random.randrange(-9, 9) + n * 20
                values += f'{self.comment()}<EnumValue key="{key}" value="{value}"/>'
            parts.append(f'<IntEnum name="a::Mode{i}">{values}</IntEnum>')
            self.names.append(f"a::Mode{i}")
        bases = ""
        free = self.random.sample(KEYS, len(KEYS))
        for i in range(4):
            members = ""
            for _ in range(8):
                child = f'<ObjectChild key="{free.pop()}">{self.type(2)}</ObjectChild>'
                members += self.comment() + child
            parts.append(f'{self.comment()}<Object name="b::Part{i}"{bases}>{members}</Object>')
            self.names.append(f"b::Part{i}")
            bases = self.random.choice(["", f' extends="b::Part{i}"'])
        self.random.shuffle(parts)
        inside = "".join(parts)
        return f"<AronTypeDefinition><GenerateTypes>{inside}</GenerateTypes></AronTypeDefinition>"


class Generated(unittest.TestCase):
    program = ""

    def test_classes_have_types_and_defaults_of_their_descriptions(self):
        with tempfile.TemporaryDirectory() as directory:
            sys.path.insert(0, directory)
            for seed in range(FILES):
                with self.subTest(seed):
                    self.check_file(Path(directory), seed)

    def check_file(self, out, seed):
        xml = out / f"made_up_{seed}.xml"
        xml.write_text(RandomXml(seed).file(), "utf-8")
        subprocess.run([self.program, out, xml], check=True)
        module = importlib.import_module(f"made_up_{seed}")
        stored = idf.decode((out / "types.idf").read_bytes())
        self.assertEqual(len(stored), 6)
        for name, data in stored.items():
            one = getattr(module, name.split("::")[1])
            self.assertEqual(one.idf_type(), idf.type_from_data(data), name)
            if issubclass(one, idf.TypedObject):
                self.check_object(one)
            else:
                self.assertEqual([int(v) for v in one], [v.value for v in one.idf_type().values])

    def check_object(self, one):
        value = one().to_idf()
        self.assertEqual(idf.check(value, one.idf_type()), [])
        self.assertTrue(idf.equal(value, idf.default_value(one.idf_type())), one)
        read = one.from_idf(idf.decode(idf.encode(value)))
        self.assertTrue(idf.equal(read.to_idf(), value), one)
        self.assertEqual(read, one())
        self.assertTrue(np.all([attribute.isidentifier() for attribute in vars(read)]))


if __name__ == "__main__":
    Generated.program = sys.argv.pop(1)
    unittest.main()
