#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What scripts/test-release reads: the README's commands, ctest's summary and its log, apt's sources.

Usage: test_release_test.py SOURCE_DIR [unittest options]
"""

import sys
import unittest
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path
from unittest import mock

SOURCE = Path()
PRINTED = """
99% tests passed, 2 tests failed out of 1234

Total Test time (real) = 9.00 sec

The following tests did not run:
\t 17 - e2e: doctor (Skipped)

The following tests FAILED:
\t  3 - common: a (b) c (Failed)
\t  4 - servo: slow (Timeout)
Errors while running CTest
"""
LOG = """1/3 Testing: one
1/3 Test: one
Output:
SKIPPED: there are no shared meshes
2/3 Test: two
passed
"""


class Read(unittest.TestCase):
    def setUp(self) -> None:
        sys.path.insert(0, str(SOURCE / "scripts"))
        loader = SourceFileLoader("test_release", str(SOURCE / "scripts/test-release"))
        self.script = module_from_spec(spec_from_loader("test_release", loader))
        loader.exec_module(self.script)

    def test_the_front_page_has_two_commands(self) -> None:
        commands = self.script.start_commands((SOURCE / "README.md").read_text(encoding="utf-8"))
        self.assertEqual([command.split()[0] for command in commands],
                         ["scripts/demo", "build/release/bin/spm-servo"])

    def test_failed_tests_are_named_and_skipped_ones_have_their_reason(self) -> None:
        self.assertEqual(self.script.outcome_of(PRINTED),
                         {"tests": 1234, "failed": ["common: a (b) c", "servo: slow"]})
        self.assertEqual(self.script.skips_of(LOG), [{"test": "one", "why": "there are no shared meshes"}])

    def test_a_summary_that_is_not_there_is_a_failure(self) -> None:
        self.assertEqual(self.script.outcome_of("ninja: build stopped")["tests"], 0)
        self.assertTrue(self.script.outcome_of("ninja: build stopped")["failed"])

    def test_another_release_is_had_from_where_this_one_is(self) -> None:
        import bare_debian
        lists = ("http://one.example/debian|bookworm|main|yes\n"
                 "http://one.example/security|bookworm-security|main|no\n"
                 "http://two.example|nodistro|main|yes\n")
        with mock.patch.object(bare_debian, "called", lambda *_: lists), \
                mock.patch.object(bare_debian, "codename_here", lambda: "bookworm"):
            self.assertEqual(bare_debian.sources("trixie"), [
                ("http://one.example/debian", "trixie", "main", True),
                ("http://one.example/security", "trixie-security", "main", False)])


if __name__ == "__main__":
    SOURCE = Path(sys.argv.pop(1)).resolve()
    sys.dont_write_bytecode = True
    unittest.main()
