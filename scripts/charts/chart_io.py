# SPDX-License-Identifier: Apache-2.0
"""The command lines of the scripts that draw or print measurements, and the files they read."""

import argparse
import csv
import json
import sys


def chart_parser(description: str) -> argparse.ArgumentParser:
    """A parser of a script that draws; gives `prefix`."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("-o", dest="prefix", required=True, help="writes PREFIX.svg and PREFIX.png")
    return parser


def add_report(parser: argparse.ArgumentParser, mode: str) -> None:
    parser.add_argument("report", help=f"JSON that spm-bench {mode} printed")


def read_report(path: str, mode: str, key: str = "rows") -> dict:
    """What `spm-bench MODE --json` printed; ends the program where that is no such report."""
    with open(path, encoding="utf-8") as file:
        report = json.load(file)
    if not report.get(key):
        sys.exit(f"{path}: no {key}; give what spm-bench {mode} --json printed")
    return report


def report_and_prefix(description: str, mode: str, key: str = "rows") -> tuple[dict, str]:
    """From a command line: a report, and where its chart goes."""
    parser = chart_parser(description)
    add_report(parser, mode)
    arguments = parser.parse_args()
    return read_report(arguments.report, mode, key), arguments.prefix


def read_columns(path: str) -> tuple[list[str], list[list[float]]]:
    """The names and the rows of a CSV of numbers."""
    with open(path, encoding="ascii", newline="") as file:
        rows = csv.reader(file)
        return next(rows, []), [[float(value) for value in row] for row in rows]
