#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Holds what the project's layout promises: which folder may use which, what the programs link,
licences, the top level, and that each equation of the paper has a function that cites it.

Usage: architecture_test.py SOURCE_DIR BUILD_DIR [unittest options]
"""

import os
import re
import subprocess
import sys
import tempfile
import unittest
from fnmatch import fnmatch
from graphlib import TopologicalSorter
from pathlib import Path

SOURCE = Path()
BUILD = Path()

# What a folder's sources may include, besides the standard library and packages.
MAY_INCLUDE = {
    "common": {"common"},
    "formats": {"common", "formats"},
    "baker": {"common", "formats", "baker"},
    "servo": {"common", "formats", "servo"},
    "tests": {"common", "formats", "baker", "servo", "tests"},
}
TOP_LEVEL = {
    ".ci", ".clang-format", ".clang-tidy", ".gitignore", "CMakeLists.txt", "CMakePresets.json",
    "LICENSES", "README.md", "baker", "common", "formats", "models", "scripts", "servo", "tests",
}
HEAVY_HEADER = re.compile(r"^((?i:CGAL)|embree\d*|openvdb|fcl)/|^bt[A-Z]")
HEAVY_TARGET = re.compile(r"cgal|embree|gmp|mpfr|openvdb|fcl|bullet", re.IGNORECASE)
LEAN_TARGETS = ("spm-servo", "spm_query", "spm_query_example", "spm_client", "spm_client_example",
                "spm_common_query", "spm_formats_asset")
DATA_FILE = re.compile(r"\.(obj|ply|stl|off|3ds|glb|gltf|3mf|exr|bin)$", re.IGNORECASE)
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]', re.MULTILINE)
MOST_FRONT_PAGE_LINES = 150
MOST_PICTURE_BYTES = 2_000_000  # what code hosts show without a wait
ROOMS_WITH_PAGES = {"common", "formats", "baker", "servo"}
EQUATIONS = range(1, 20)
EQUATION_TABLE = Path("common/paper/README.md")
# Number, function, file and test.
EQUATION_ROW = re.compile(r"^\| (\d+) \|.*\| `(\w+)` \| \[`[^`]+`\]\(([^)]+)\) "
                          r"\| \[test\]\(([^)]+)\) \|.*\|$", re.MULTILINE)
# A docstring, then a declaration up to its parameter list.
DOCUMENTED = re.compile(r"((?:^[ \t]*///.*\n)+)^[ \t]*([^/\n#][^;{}]*?\b(\w+)\s*\()", re.MULTILINE)
# "eq. 7", "eq. 7, 8", "eq. 10 and 11", "eq. 3 to 8"
CITATION = re.compile(r"\beq\.\s*(\d+(?:(?:,| and| to) \d+)*)")
# Tests that include nothing of the room they are about.
TESTED_FROM_OUTSIDE = {
    Path("tests/servo/commands/command_test.cpp"),  # the program as it is run
    Path("tests/servo/scene/scene_edit_tick_test.cpp"),  # edits as the loop takes them up
}


def project_files() -> list[Path]:
    """Every file of the project, relative: what git tracks or would add; in an export, all files."""
    try:
        listed = subprocess.run(
            ["git", "-c", f"safe.directory={SOURCE}", "-C", SOURCE, "ls-files", "-z", "--cached",
             "--others", "--exclude-standard"],
            check=True, capture_output=True, text=True).stdout
        found = [Path(name) for name in listed.split("\0") if name]
    except (OSError, subprocess.CalledProcessError):
        found = [path.relative_to(SOURCE) for path in SOURCE.rglob("*") if path.is_file()]
        found = [path for path in found
                 if path.parts[0] not in {".git", "build"} and "__pycache__" not in path.parts
                 and not (path.parts[0] == "models" and path.suffix == ".obj")]
    return sorted(path for path in found if (SOURCE / path).is_file())


def text_of(path: Path) -> str:
    return (SOURCE / path).read_text(encoding="utf-8")


def is_cpp(path: Path) -> bool:
    return path.suffix in {".cpp", ".hpp", ".c", ".h"}


def is_source(path: Path) -> bool:
    """Sources, scripts, CMake files and tool settings: whatever can carry a comment."""
    if is_cpp(path) or path.suffix in {".py", ".cmake"} or path.name == "CMakeLists.txt":
        return True
    if path.name in {".clang-format", ".clang-tidy"}:
        return True
    return path.parts[0] in {"scripts", ".ci"} and path.suffix in {"", ".txt"}


def includes(path: Path) -> list[tuple[str, bool]]:
    """Included names with whether they are quoted."""
    return [(name, mark == '"') for mark, name in INCLUDE.findall(text_of(path))]


def folder_of_include(path: Path, name: str) -> str | None:
    """Our folder that a quoted include leads into; None where it leads nowhere of ours."""
    if found := file_of_include(path, name):
        return found.parts[0]
    # The C library's header, as a program that uses the library includes it.
    return "formats" if (SOURCE / "formats" / "query" / name).is_file() else None


def link_graph() -> dict[str, set[str]]:
    """Targets and what they link directly, as CMake knows it (written by architecture.cmake)."""
    graph = {}
    for line in (BUILD / "link-graph.txt").read_text(encoding="utf-8").splitlines():
        target, _, linked = line.partition(":")
        graph[target] = set(linked.split())
    return graph


def rooms() -> dict[str, set[str]]:
    """Rooms and those they may use, as the CMake files say (written by architecture.cmake)."""
    found = {}
    for line in (BUILD / "rooms.txt").read_text(encoding="utf-8").splitlines():
        room, _, used = line.partition(":")
        found[room] = set(used.split())
    return found


def file_of_include(path: Path, name: str) -> Path | None:
    """Our file that a quoted include names; None where it is none of ours."""
    for found in (Path(name), path.parent / name):
        if (SOURCE / found).is_file():
            return Path(str(found))
    return None


def citations() -> dict[tuple[Path, str], set[int]]:
    """The numbers of the equations that the docstring of each function cites."""
    found: dict[tuple[Path, str], set[int]] = {}
    for path in project_files():
        if is_cpp(path) and path.parts[0] in {"common", "baker", "servo", "formats"}:
            for docstring, _, name in DOCUMENTED.findall(text_of(path)):
                text = re.sub(r"\s*\n\s*///\s*", " ", docstring)
                for cited in CITATION.findall(text):
                    numbers = found.setdefault((path, name), set())
                    numbers.update(map(int, re.findall(r"\d+", cited)))
                    for first, last in re.findall(r"(\d+) to (\d+)", cited):
                        numbers.update(range(int(first), int(last) + 1))
    return found


def reachable(graph: dict[str, set[str]], start: str) -> set[str]:
    found, open_ends = set(), [start]
    while open_ends:
        for name in graph.get(open_ends.pop(), ()):
            if name not in found:
                found.add(name)
                open_ends.append(name)
    return found


class Folders(unittest.TestCase):
    def test_a_folder_includes_only_what_it_may(self) -> None:
        wrong = []
        for path in filter(is_cpp, project_files()):
            for name, quoted in includes(path):
                folder = folder_of_include(path, name) if quoted else None
                if quoted and folder is None:
                    wrong.append(f'{path}: #include "{name}" is no file of ours; use <...>')
                elif quoted and folder not in MAY_INCLUDE[path.parts[0]]:
                    wrong.append(f'{path}: {path.parts[0]} must not include "{name}"')
        self.assertEqual(wrong, [])

    def test_the_folders_form_no_cycle(self) -> None:
        uses: dict[str, set[str]] = {}
        for path in filter(is_cpp, project_files()):
            for name, quoted in includes(path):
                folder = folder_of_include(path, name) if quoted else None
                if folder and folder != path.parts[0]:
                    uses.setdefault(path.parts[0], set()).add(folder)
        self.assertIn("common", list(TopologicalSorter(uses).static_order()))

    def test_a_room_includes_only_what_its_cmake_file_says_and_uses_all_of_that(self) -> None:
        allowed = rooms()
        self.assertGreater(len(allowed), 40)
        used: dict[str, set[str]] = {room: set() for room in allowed}
        wrong = []
        for path in filter(is_cpp, project_files()):
            room = str(path.parent)
            if path.parts[0] == "tests" or room in {"formats/query", "servo/client/examples"}:
                continue
            if room not in allowed:
                wrong.append(f"{path}: lies in no room")
                continue
            for name, quoted in includes(path):
                found = file_of_include(path, name) if quoted else None
                if found is None or found.parent == path.parent:
                    continue
                used[room].add(str(found.parent))
                if str(found.parent) not in allowed[room]:
                    wrong.append(f'{path}: {room} must not include "{name}"')
        self.assertEqual(wrong, [])
        self.assertEqual({room: allowed[room] - used[room] for room in allowed
                          if allowed[room] - used[room]}, {})

    def test_a_test_lies_where_its_subject_lies(self) -> None:
        """In the folder of a room, a test includes a header of that room, itself or through a header
        of the tests."""
        allowed = rooms()
        wrong = []
        for path in project_files():
            room = path.parent.relative_to("tests") if path.parts[0] == "tests" else None
            if room is None or not path.name.endswith("_test.cpp") or str(room) not in allowed:
                continue
            names = [name for name, quoted in includes(path) if quoted]
            for found in filter(None, [file_of_include(path, name) for name in names]):
                if found.parts[0] == "tests":
                    names += [name for name, quoted in includes(found) if quoted]
            if room not in {Path(name).parent for name in names} and path not in TESTED_FROM_OUTSIDE:
                wrong.append(f"{path}: includes nothing of {room}")
        self.assertEqual(wrong, [])

    def test_the_rooms_form_no_cycle(self) -> None:
        self.assertGreater(len(list(TopologicalSorter(rooms()).static_order())), 40)

    def test_the_drawing_of_the_rooms_is_that_of_these_includes(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            drawn = Path(folder) / "rooms.svg"
            subprocess.run([sys.executable, "-B", SOURCE / "scripts/draw_rooms", "-o", drawn],
                           check=True, capture_output=True)
            self.assertEqual(drawn.read_text(), text_of(Path("tests/bench/charts/rooms.svg")),
                             "scripts/draw_rooms -o tests/bench/charts/rooms.svg draws it anew")

    def test_each_room_has_a_page(self) -> None:
        missing = [room for room in rooms() if room.split("/")[0] in ROOMS_WITH_PAGES
                   and not (SOURCE / room / "README.md").is_file()]
        self.assertEqual(missing, [])

    def test_the_page_of_a_room_names_its_files_and_no_others(self) -> None:
        """Anywhere on the page; with a star where one row tells of several. What a table of files
        names is there."""
        wrong = []
        for room in rooms():
            if room.split("/")[0] not in ROOMS_WITH_PAGES:
                continue
            page = text_of(Path(room) / "README.md")
            there = {path.name for path in project_files() if str(path.parent) == room and is_cpp(path)}
            stars = [name for name in re.findall(r"`([\w.*]+)`", page) if "*" in name]
            wrong += [f"{room}/README.md does not name {name}" for name in sorted(there)
                      if not re.search(rf"\b{re.escape(Path(name).stem)}\b", page)
                      and not any(fnmatch(name, star) for star in stars)]
            for table in re.findall(r"^\| file \|.*\n\|[-|]+\n((?:\|.*\n?)+)", page, re.MULTILINE):
                cells = [row.split("|")[1] for row in table.splitlines()]
                wrong += [f"{room}/README.md names {name}, which is not there" for cell in cells
                          for name in re.findall(r"`([\w*]+(?:\.\w+)?)`", cell)
                          if not any(fnmatch(file, name) or Path(file).stem == name
                                     for file in os.listdir(SOURCE / room))]
        self.assertEqual(wrong, [])

    def test_only_the_baker_and_tests_include_cgal_and_embree(self) -> None:
        wrong = [f"{path}: <{name}>" for path in filter(is_cpp, project_files())
                 if path.parts[0] not in {"baker", "tests"}
                 for name, _ in includes(path) if HEAVY_HEADER.match(name)]
        self.assertEqual(wrong, [])

    def test_the_top_level_is_the_agreed_one(self) -> None:
        found = {path.parts[0] for path in project_files()}
        self.assertEqual(found - TOP_LEVEL, set())
        self.assertEqual(TOP_LEVEL - found, set())


class Links(unittest.TestCase):
    def test_the_link_graph_reaches_neither_cgal_nor_embree_nor_the_baker_from_the_servo(self) -> None:
        graph = link_graph()
        for target in LEAN_TARGETS:
            self.assertIn(target, graph)
            heavy = {name for name in reachable(graph, target)
                     if HEAVY_TARGET.search(name) or name.startswith("spm_baker")}
            self.assertEqual(heavy, set(), f"{target} links what only the baker may")

    def test_the_link_graph_sees_cgal_and_embree_behind_the_baker(self) -> None:
        names = " ".join(reachable(link_graph(), "spm-bake"))
        self.assertIn("CGAL", names)
        self.assertIn("embree", names)

    def test_the_built_servo_and_query_library_need_neither_cgal_nor_embree(self) -> None:
        for binary in (BUILD / "bin" / "spm-servo", BUILD / "lib" / "libspm_query.so"):
            with self.subTest(binary=binary.name):
                if not binary.exists():
                    self.skipTest(f"{binary.name} is not built")
                needed = subprocess.run(["ldd", binary], check=True, capture_output=True,
                                        text=True).stdout
                self.assertIsNone(HEAVY_TARGET.search(needed.replace(str(BUILD), "")), needed)
                self.assertNotIn(b"N4CGAL", binary.read_bytes())


class Pages(unittest.TestCase):
    def test_every_package_has_its_reason_in_the_dependency_table(self) -> None:
        table = text_of(Path("scripts/PACKAGES.md"))
        lists = [path for path in project_files() if path.parent == Path("scripts/packages")]
        self.assertGreaterEqual({path.stem for path in lists}, {"run", "test", "bench", "lint"})
        packages = {name for path in lists
                    for name in re.findall(r"^([a-z0-9][a-z0-9.+-]*)$", text_of(path), re.MULTILINE)}
        self.assertGreater(len(packages), 10)
        self.assertEqual([name for name in sorted(packages) if f"`{name}`" not in table], [])

    def test_the_front_page_is_short_and_its_picture_light(self) -> None:
        page = text_of(Path("README.md"))
        self.assertLessEqual(len(page.splitlines()), MOST_FRONT_PAGE_LINES)
        pictures = re.findall(r"!\[[^\]]*\]\(([^)]+)\)", page)
        self.assertTrue(any(name.endswith(".gif") for name in pictures))
        self.assertEqual([name for name in pictures
                          if (SOURCE / name).stat().st_size > MOST_PICTURE_BYTES], [])

    def test_links_between_the_pages_lead_somewhere(self) -> None:
        pages = [path for path in project_files() if path.suffix == ".md"]
        broken = [f"{page}: {link}" for page in pages
                  for link in re.findall(r"\]\(([^)#:\s]+)\)", text_of(page))
                  if not (SOURCE / page.parent / link).exists()]
        self.assertEqual(broken, [])


class Sources(unittest.TestCase):
    def test_every_source_names_its_licence_in_its_first_two_lines(self) -> None:
        wrong = []
        for path in filter(is_source, project_files()):
            baker = path.parts[0] == "baker" or path.parts[:2] in {("tests", "baker"),
                                                                   ("tests", "bench"),
                                                                   ("tests", "stability")}
            if path.parts[0] == "tests" and is_cpp(path):
                baker = baker or any(HEAVY_HEADER.match(name) or name.startswith(("baker/", "tests/baker/"))
                                     for name, _ in includes(path))
            wanted = "GPL-3.0-or-later" if baker else "Apache-2.0"
            head = "\n".join(text_of(path).splitlines()[:2])
            found = re.search(r"SPDX-License-Identifier: (\S+)", head)
            if not found or found[1] != wanted:
                wrong.append(f"{path}: {found[1] if found else 'none'} instead of {wanted}")
        self.assertEqual(wrong, [])

    def test_the_licence_texts_are_there(self) -> None:
        for name in ("Apache-2.0", "GPL-3.0-or-later"):
            self.assertGreater((SOURCE / "LICENSES" / f"{name}.txt").stat().st_size, 10000)

    def test_no_mesh_or_baked_file_is_tracked(self) -> None:
        self.assertEqual([str(path) for path in project_files() if DATA_FILE.search(path.name)], [])

    def test_each_equation_has_a_function_that_cites_it(self) -> None:
        cited = set().union(*citations().values())
        self.assertEqual([number for number in EQUATIONS if number not in cited], [])

    def test_the_table_of_equations_names_functions_that_cite_them_and_tests_that_call_them(
            self) -> None:
        cited = citations()
        rows = EQUATION_ROW.findall(text_of(EQUATION_TABLE))
        self.assertEqual([int(row[0]) for row in rows], list(EQUATIONS))
        folder = SOURCE / EQUATION_TABLE.parent
        for number, name, file, test in rows:
            with self.subTest(equation=number):
                path = (folder / file).resolve().relative_to(SOURCE)
                self.assertIn(int(number), cited.get((path, name), set()))
                self.assertRegex((folder / test).read_text(encoding="utf-8"), rf"\b{name}\b")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    SOURCE, BUILD = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
