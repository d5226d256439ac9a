# SPDX-License-Identifier: Apache-2.0
"""Measured figures on the project's pages. Each stands between two marks, which are comments of
HTML, and is computed from the JSON files under tests/bench/charts:

    a query takes <!-- figure: methods.rows(mesh="duck", settings="tolerance 100 um").ns.hot
    -->116<!-- /figure --> ns

What a mark computes is a Python expression over the reports, each under its file's name. Called, a
list of rows gives those whose values match (`*` in a text matches anything); a field of rows is the
field of the only one. `span(...)` gives "least to largest", `spm(mesh)` the row of methods.json of
our method at the mesh's own tolerance. After " : " a format may follow, as in an f-string. The
functions of page_tables.py give whole tables: a block between marks on lines of their own.
"""

import ast
import fnmatch
import functools
import json
import re
from pathlib import Path
from typing import Iterator, NamedTuple

import page_tables

SOURCE = Path(__file__).resolve().parents[2]
CHARTS = Path("tests/bench/charts")
MARK = re.compile(r"<!--\s*figure:\s+(?P<what>.*?)\s*-->(?P<shown>.*?)<!--\s*/figure\s*-->",
                  re.DOTALL)
CODE = re.compile(r"^(```|~~~).*?^\1", re.DOTALL | re.MULTILINE)
BUILTINS = {"abs": abs, "all": all, "any": any, "len": len, "max": max, "min": min,
            "round": round, "set": set, "sorted": sorted, "str": str, "sum": sum,
            "span": page_tables.span}

# What a page may not say by hand where it tells what was measured.
UNIT = r"(?:[mun]?s|[kMG]B|%|um|[mu]?J|deg|degrees|times|N(?:/m)?)"
BARE = re.compile(rf"\d[\d,.]*(?:\s(?:to|and|/)\s\d[\d,.]*)*\s?(?<!\w){UNIT}(?![\w/])(?! s/m)")
NOT_MEASURED = re.compile(r"<!--\s*not measured\s*-->.*?<!--\s*/not measured\s*-->", re.DOTALL)
HEADING = re.compile(r"(#+) (.*)")


class Figure(NamedTuple):
    """A mark on a page: line, expression, what the page shows and what the reports give."""
    line: int
    what: str
    shown: str
    right: str


def wrapped(value):
    if isinstance(value, dict):
        return Record(value)
    return Rows(value) if isinstance(value, list) else value


class Record:
    """A JSON object whose keys are attributes."""

    def __init__(self, values: dict) -> None:
        self._values = values

    def __getattr__(self, key: str):
        if key not in self._values:
            raise KeyError(f"no '{key}'; there is {', '.join(self._values)}")
        return wrapped(self._values[key])

    def matches(self, wanted: dict) -> bool:
        return all(fnmatch.fnmatchcase(has, value)
                   if isinstance(value, str) and isinstance(has := self._values.get(key), str)
                   else self._values.get(key) == value for key, value in wanted.items())


class Rows(list):
    """A JSON array. Called with keys and values, the records that have them."""

    def __init__(self, values) -> None:
        super().__init__(map(wrapped, values))

    def __call__(self, **wanted) -> "Rows":
        found = Rows([])
        found += [row for row in self if row.matches(wanted)]
        return found

    def __getattr__(self, key: str):
        if len(self) != 1:
            raise KeyError(f"'{key}' of {len(self)} rows, where one is needed")
        return getattr(self[0], key)


def reports_of(source: Path) -> dict[str, dict]:
    return {path.stem: json.loads(path.read_text(encoding="utf-8"))
            for path in sorted((source / CHARTS).glob("*.json"))}


def names_of(reports: dict[str, dict]) -> dict:
    """All that an expression may name."""
    tables = {name: functools.partial(function, reports)
              for name, function in page_tables.TABLES.items()}
    spm = {"spm": lambda mesh: wrapped(page_tables.own_row(reports["methods"], mesh))}
    return BUILTINS | tables | spm | {name: wrapped(report) for name, report in reports.items()}


def text_of(value, form: str) -> str:
    """How a page shows a value: lines as a block, a number by the format, else as `number` does."""
    if isinstance(value, list):
        return "\n\n" + "\n".join(value) + "\n\n"
    if form:
        return format(value, form)
    return page_tables.number(value) if isinstance(value, (int, float)) else str(value)


def value_of(what: str, names: dict):
    tree = ast.parse(what, mode="eval")
    for node in ast.walk(tree):
        name = getattr(node, "attr", getattr(node, "id", ""))
        if str(name).startswith("_"):
            raise ValueError(f"'{name}' is no name for a figure")
    return eval(compile(tree, "figure", "eval"), {"__builtins__": {}, **names})  # checked above


def figures_of(text: str, names: dict) -> Iterator[tuple[re.Match, Figure]]:
    """Every mark outside code blocks. Raises ValueError where an expression will not do."""
    without_code = blanked(text, CODE)
    if text_left := re.search(r"<!--\s*/?figure\b", blanked(without_code, MARK)):
        line = text.count("\n", 0, text_left.start()) + 1
        raise ValueError(f"{line}: a mark without its other half")
    for match in MARK.finditer(without_code):
        line = text.count("\n", 0, match.start()) + 1
        what, _, form = " ".join(match["what"].split()).partition(" : ")
        try:
            right = text_of(value_of(what, names), form)
        except Exception as problem:  # whatever an expression may raise, tell where it stands
            raise ValueError(f"{line}: {what}: {problem}") from problem
        at_start = text[text.rfind("\n", 0, match.start()) + 1:match.start()].strip() == ""
        if at_start != right.startswith("\n"):
            raise ValueError(f"{line}: {what}: " + (
                "begins a line, which ends the paragraph in Markdown; put a word before it"
                if at_start else "is a block; begin a line with it"))
        yield match, Figure(line, what, match["shown"], right)


def blanked(text: str, pattern: re.Pattern) -> str:
    """The text with spaces for what matches, so that places and lines stay."""
    return pattern.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)


def rendered(text: str, names: dict) -> str:
    """The page with every figure as the reports have it."""
    pieces, end = [], 0
    for match, figure in figures_of(text, names):
        pieces += [text[end:match.start("shown")], figure.right]
        end = match.end("shown")
    return "".join(pieces) + text[end:]


def bare_figures(text: str, whole_page: bool) -> list[tuple[int, str]]:
    """Lines with a figure by hand: a number with a unit, or a number in a table, outside marks.
    They are looked for under headings with the word "measured", or on the whole page, there in text
    only; code, and what stands between `not measured` marks, is left out."""
    for pattern in (MARK, NOT_MEASURED, CODE, re.compile(r"<!--.*?-->", re.DOTALL),
                    re.compile(r"`[^`]*`"), re.compile(r"\]\([^)]*\)")):
        text = blanked(text, pattern)
    found, level = [], 0
    for number, line in enumerate(text.splitlines(), 1):
        if heading := HEADING.match(line):
            depth = len(heading[1])
            if level and depth <= level:
                level = 0
            if not level and re.search(r"\bmeasured\b", heading[2], re.IGNORECASE):
                level = depth
        elif level or whole_page:
            is_table = level and line.lstrip().startswith("|") and re.search(r"\d", line)
            if is_table or BARE.search(line):
                found.append((number, line.strip()))
    return found


def pages_of(source: Path) -> list[Path]:
    """The project's pages, relative to `source`."""
    return sorted(path.relative_to(source) for path in source.rglob("*.md")
                  if not {"build", ".git", "_deps"} & set(path.relative_to(source).parts))
