# SPDX-License-Identifier: Apache-2.0
"""A memory in the browser, opened from Python."""

import json
import os
import pathlib
import sys
import tempfile
import unittest
import urllib.error
import urllib.request
import xml.etree.ElementTree

import engram
from engram import errors

ENGRAM = sys.argv.pop(1)
START = 1_600_000_000 * 10**9
NAME = "Objects/Instances/a<b>&\"c\"/cup"


class ViewTest(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name) / "store.engram"
        with engram.record(self.path) as recorder:
            for i in range(20):
                recorder.commit(NAME, {"x": float(i)}, START + i * 10**9)

    def get(self, url: str) -> tuple[int, str, bytes]:
        browser = urllib.request.build_opener(urllib.request.HTTPCookieProcessor())
        with browser.open(url, timeout=20) as answer:
            policy = answer.headers["Content-Security-Policy"]
            with browser.open(answer.url.split("?")[0] + "api/info", timeout=20) as info:
                return answer.status, policy, info.read()

    def test_a_notebook_shows_it_in_a_frame(self) -> None:
        with engram.open(self.path) as memory:
            view = memory.view(program=ENGRAM, notebook="http://localhost:8899", height=300)
        with view:
            self.assertTrue(view.url.startswith("http://localhost:"), view.url)
            status, policy, info = self.get(view.url.replace("//localhost:", "//127.0.0.1:"))
            self.assertEqual(status, 200)
            self.assertIn("frame-ancestors http://localhost:8899", policy)
            self.assertEqual(json.loads(info)["snapshots"], 20)
            shown = view._repr_mimebundle_()
            self.assertIn(view.url.replace("&", "&amp;"), shown["text/html"])
            self.assertIn('height="300"', shown["text/html"])
            self.assertIn(view.url, repr(view))
        with self.assertRaises(urllib.error.URLError):
            urllib.request.urlopen(view.url.replace("//localhost:", "//127.0.0.1:"), timeout=5)
        self.assertIn("closed", repr(view))
        view.close()

    def test_the_picture_stays_where_the_page_is_not_reached(self) -> None:
        with engram.open(self.path) as memory, memory.view(program=ENGRAM) as view:
            shown = view._repr_mimebundle_()
        picture = xml.etree.ElementTree.fromstring(shown["image/svg+xml"])
        texts = [one.text for one in picture.iter("{http://www.w3.org/2000/svg}text")]
        self.assertEqual(texts, [NAME, "20", "2020-09-13 12:26:40 to 2020-09-13 12:26:59 UTC"])
        self.assertIn(shown["image/svg+xml"], shown["text/html"])

    def test_what_goes_wrong_is_said(self) -> None:
        with engram.open(self.path) as memory:
            with self.assertRaisesRegex(errors.NotFoundError, "no/such/engram"):
                memory.view(program="no/such/engram")
            with self.assertRaisesRegex(errors.FailedPreconditionError, "--nonsense"):
                memory.view(program=ENGRAM, options=["--nonsense"])
            with self.assertRaisesRegex(errors.FailedPreconditionError, "not an origin|origin"):
                memory.view(program=ENGRAM, notebook="javascript:alert(1)")
            with self.assertRaises(errors.InvalidArgumentError):
                memory.view(program=ENGRAM, height=5)
            os.rename(self.path, f"{self.path}.gone")
            with self.assertRaisesRegex(errors.FailedPreconditionError, "store.engram"):
                memory.view(program=ENGRAM)


if __name__ == "__main__":
    unittest.main()
