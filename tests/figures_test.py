#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Holds that every measured figure on a page is what its JSON file has, that none stands there by
hand, and that each JSON file tells what made it.

Usage: figures_test.py SOURCE_DIR [unittest options]
"""

import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path()
# Pages that are held as a whole; of all others, what stands under a heading with "measured".
WHOLE_PAGES = {"README.md"}
# Of a machine: what only reports of spm-bench tell, or only the others.
UNEQUAL = ("embree", "openvdb", "spm")


def check(folder: Path) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, SOURCE / "scripts/render_figures", "--check", "--source",
                           folder], capture_output=True, text=True, check=False)


class Pages(unittest.TestCase):
    def test_every_figure_is_what_its_json_file_has(self) -> None:
        found = check(SOURCE)
        self.assertEqual(found.returncode, 0, "\n" + found.stderr)

    def test_borders_in_the_code_are_what_the_laboratory_measured(self) -> None:
        found = subprocess.run([sys.executable, SOURCE / "scripts/write_borders", "--check"],
                               capture_output=True, text=True, check=False)
        self.assertEqual(found.returncode, 0, "\n" + found.stderr)

    def test_no_figure_stands_on_a_page_by_hand(self) -> None:
        bare = [f"{page}:{line}: {text}" for page in figures.pages_of(SOURCE)
                for line, text in figures.bare_figures(
                    (SOURCE / page).read_text(encoding="utf-8"), str(page) in WHOLE_PAGES)]
        if bare:
            self.fail("\n".join([*bare, "put figures between marks, as scripts/charts/figures.py "
                                 "tells; what was not measured goes between 'not measured' marks"]))

    def test_every_report_tells_commit_machine_and_command(self) -> None:
        reports = sorted((SOURCE / figures.CHARTS).glob("*.json"))
        self.assertGreater(len(reports), 5)
        for report in reports:
            with self.subTest(report.name):
                made = json.loads(report.read_text(encoding="utf-8"))["made"]
                self.assertRegex(made["commit"], r"^[0-9a-f]{7,40}$")
                self.assertTrue(made["machine"]["processor"] and made["command"])
                self.assertNotIn("/home", json.dumps(made))
                self.assertRegex(made["machine"]["kernel"], r"^Linux [0-9.]+$")

    def test_no_report_names_a_path_of_the_machine(self) -> None:
        for report in sorted((SOURCE / figures.CHARTS).glob("*.json")):
            with self.subTest(report.name):
                paths = re.findall(r'"/(?!dev/)[^"]*"', report.read_text(encoding="utf-8"))
                self.assertEqual(sorted(set(paths)), [])

    def test_reports_that_are_compared_come_from_one_machine(self) -> None:
        machines: dict[bool, dict] = {False: {}, True: {}}
        for report in sorted((SOURCE / figures.CHARTS).glob("*.json")):
            made = json.loads(report.read_text(encoding="utf-8"))["made"]
            # Releases and public meshes are compared with one another alone.
            if made["command"] in ("scripts/test-release", "scripts/try_meshes"):
                continue
            machine = made["machine"]
            # A kernel takes some pages more or less from one start to the next.
            machine["memory_bytes"] = round(machine["memory_bytes"] / 2**24)
            # The bytes and times of queries have a page's sections of their own.
            alone = made["command"].startswith(("spm-bench bytes", "spm-bench methods"))
            machines[alone][json.dumps({**machine, **dict.fromkeys(UNEQUAL)},
                                       sort_keys=True)] = report.name
        for group in machines.values():
            self.assertEqual(len(group), 1, f"{group}: measure all with scripts/measure")


class Marks(unittest.TestCase):
    """A page and a report of their own."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory(prefix="spm-figures-")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        (self.folder / figures.CHARTS).mkdir(parents=True)
        report = {"rows": [{"mesh": "duck", "ns": 116.09}, {"mesh": "teeth", "ns": 2160.95}]}
        (self.folder / figures.CHARTS / "times.json").write_text(json.dumps(report))

    def page(self, text: str) -> Path:
        path = self.folder / "page.md"
        path.write_text(text, encoding="utf-8")
        return path

    def test_a_wrong_figure_is_told_with_page_line_path_and_both_values(self) -> None:
        self.page('\nIt takes <!-- figure: times.rows(mesh="duck").ns -->118<!-- /figure --> ns.\n')
        found = check(self.folder)
        self.assertEqual(found.returncode, 1)
        self.assertIn('page.md:2: times.rows(mesh="duck").ns: the page has 118, the JSON 116',
                      found.stderr)

    def test_rendering_writes_the_figures_and_nothing_else(self) -> None:
        path = self.page('A <!-- figure: max(row.ns for row in times.rows)\n--><!-- /figure --> b\n'
                         '<!-- figure: times.rows(mesh="d*").ns / 1e3 : .3f -->7<!-- /figure -->\n')
        self.assertIn("begins a line", check(self.folder).stderr)
        text = path.read_text(encoding="utf-8").replace("b\n<", "b <")
        self.page(text)
        subprocess.run([sys.executable, SOURCE / "scripts/render_figures", "--source", self.folder],
                       check=True, capture_output=True)
        self.assertEqual(path.read_text(encoding="utf-8"),
                         text.replace("--><!-- /", "-->2,161<!-- /").replace("7<", "0.116<"))
        self.assertEqual(check(self.folder).returncode, 0)

    def test_marks_that_will_not_do_are_told(self) -> None:
        for mark, words in (("times.rows(mesh='cat').ns", "'ns' of 0 rows"),
                            ("times.row", "no 'row'; there is rows"),
                            ("times.rows.__class__", "no name for a figure"),
                            ("open('x')", "'open' is not defined")):
            with self.subTest(mark):
                self.page(f"x <!-- figure: {mark} -->1<!-- /figure -->\n")
                self.assertIn(words, check(self.folder).stderr)
        self.page("x <!-- figure: 1 -->1\n")
        self.assertIn("page.md:1: a mark without its other half", check(self.folder).stderr)
        self.page("```\n<!-- figure: 1 -->\n```\n")
        self.assertEqual(check(self.folder).returncode, 0)

    def test_figures_by_hand_are_found_where_something_was_measured(self) -> None:
        def lines(text: str, whole_page: bool = False) -> list[int]:
            return [line for line, _ in figures.bare_figures(text, whole_page)]

        self.assertEqual(lines("# A\n5 us\n## Measured\n5 us\n### B\n3 to 7 % more\n## C\n5 us\n"),
                         [4, 6])
        self.assertEqual(lines("# A\n16 MB\n1 N/mm, 2 mm, 2.5 N s/m\n", True), [2])
        self.assertEqual(lines("# Measured\n| a | 5 |\n`5 us` [a](5 us) "
                               "<!-- not measured -->5 us<!-- /not measured --> <!-- figure: 5 -->5"
                               "<!-- /figure --> us\n"), [2])


if __name__ == "__main__":
    SOURCE = Path(sys.argv.pop(1)).resolve()
    sys.dont_write_bytecode = True
    sys.path.insert(0, str(SOURCE / "scripts" / "charts"))
    import figures
    unittest.main()
