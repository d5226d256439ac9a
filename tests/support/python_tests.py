#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a file of unittest tests for ctest, so that a skip is one that ctest counts and names.

Usage: python_tests.py [--without CLASS.test]... FILE [ARGUMENT...]

Prints `SKIPPED: test: why` for each skipped test. Ends with 77 where a test was skipped and none
failed, else with what unittest ends with. --without leaves out a test that has an entry of its own.
"""

import os
import runpy
import sys
import unittest

SKIP_CODE = 77
without: set[str] = set()
skipped: list[tuple[unittest.TestCase, str]] = []


def chosen(suite: unittest.TestSuite) -> unittest.TestSuite:
    """The suite less the tests of --without."""
    kept = unittest.TestSuite()
    for test in suite:
        if isinstance(test, unittest.TestSuite):
            kept.addTest(chosen(test))
        elif test.id().removeprefix("__main__.") not in without:
            kept.addTest(test)
    return kept


class NamingRunner(unittest.TextTestRunner):
    """A runner that remembers what was skipped."""

    def run(self, test):
        result = super().run(chosen(test))
        skipped.extend(result.skipped)
        return result


def main(arguments: list[str]) -> int:
    while arguments[:1] == ["--without"] and len(arguments) > 2:
        without.add(arguments[1])
        del arguments[:2]
    if not arguments:
        sys.exit(__doc__)
    path = os.path.abspath(arguments[0])
    # As if the file had been started: its neighbours can be imported, its arguments are its own.
    sys.argv = [path, *arguments[1:]]
    sys.path[0] = os.path.dirname(path)
    unittest.runner.TextTestRunner = NamingRunner  # what unittest.main takes
    code = 0
    try:
        runpy.run_path(path, run_name="__main__")
    except SystemExit as end:
        code = end.code
    for test, why in skipped:
        print(f"SKIPPED: {test.id().removeprefix('__main__.')}: {why}", flush=True)
    return SKIP_CODE if skipped and not code else code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
