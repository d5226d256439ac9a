#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes what `spm-bench stability --json` measured as Markdown: the cases against the methods, the
largest good stiffness, the theory check, static loops and targets."""

import argparse
import json
import sys

LETTERS = {"good": "+", "between": "~", "bad": "x"}


def table(head: list[str], rows: list[list[str]]) -> list[str]:
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return [*lines, *("| " + " | ".join(row) + " |" for row in rows), ""]


def names_of(rows: list[dict], key: str) -> list[str]:
    return list(dict.fromkeys(row[key] for row in rows))


def letter(row: dict) -> str:
    return "P" if row["popped"] else LETTERS[row["verdict"]]


def verdict_lines(report: dict) -> list[str]:
    methods = names_of(report["cases"], "method")
    lines = ["## Verdicts", "",
             f"A letter a profile, {', '.join(names_of(report['cases'], 'device'))}: `+` good, `~` "
             "between, `x` bad, `P` popped through. The worst of a case's seeds counts. No letters: "
             "the method has no such form, or not the effect that the case is about.", ""]
    for fraction in sorted({row["fraction"] for row in report["cases"]}):
        cells: dict[tuple[str, str], str] = {}
        good = dict.fromkeys(methods, 0)
        for row in report["cases"]:
            if row["fraction"] == fraction:
                key = (row["case"], row["method"])
                cells[key] = cells.get(key, "") + letter(row)
                good[row["method"]] += row["stable"]
        counts = {method: sum(len(cell) for key, cell in cells.items() if key[1] == method)
                  for method in methods}
        cases = [case for case in names_of(report["catalogue"], "case")
                 if any((case, method) in cells for method in methods)]
        lines += [f"At {fraction:g} of each profile's own flat border:", ""]
        lines += table(["case", *methods], [
            [case, *(f"`{cells[case, method]}`" if (case, method) in cells else ""
                     for method in methods)] for case in cases] + [
            ["share good", *(f"{100 * good[method] / counts[method]:.0f} %" if counts[method] else ""
                             for method in methods)]])
    return lines


def border_lines(report: dict) -> list[str]:
    flats = {row["device"]: row for row in report["flat_borders"]}
    lines = ["## Largest good stiffness", ""]
    lines += table(["profile", "flat border, N/m", "of it all that is linear, N/m"], [
        [device, f"{row['border_n_m']:.0f}",
         "" if row["linear_n_m"] is None else f"{row['linear_n_m']:.0f}"]
        for device, row in flats.items()])
    for device in names_of(report["borders"], "device"):
        rows = [row for row in report["borders"] if row["device"] == device]
        methods = names_of(rows, "method")
        cells = {(row["case"], row["method"]): f"{row['border_n_m']:.0f}" for row in rows}
        lines += [f"On {device}, N/m; 0: it fails at the least that is tried:", ""]
        lines += table(["case", *methods], [
            [case, *(cells.get((case, method), "") for method in methods)]
            for case in names_of(rows, "case")])
    return lines


def theory_lines(report: dict) -> list[str]:
    if not report["theory"]:
        return []
    body = []
    for criterion in names_of(report["theory"], "criterion"):
        rows = [row for row in report["theory"] if row["criterion"] == criterion]
        offs = sorted(100 * (row["off"] or 0) for row in rows)
        body.append([criterion, rows[0]["kind"], str(len(rows)), f"{offs[0]:+.3f} to {offs[-1]:+.3f} %"])
    return ["## Theory against the plant", "",
            "Passivity and stability are different borders; each is held against its own criterion.",
            "", *table(["criterion", "kind", "loops", "the plant is off by"], body)]


def failing_lines(report: dict) -> list[str]:
    rows = [row for row in report["cases"]
            if row["method"] == "default" and row["fraction"] == 0.6 and not row["stable"]]
    lines = ["## Where the default still fails at 0.6", ""]
    if not rows:
        return [*lines, "Nowhere in this run.", ""]
    return lines + table(["case", "profile", "verdict", "reason"], [
        [row["case"], row["device"], row["verdict"], row["reason"]] for row in rows])


def loop_lines(report: dict) -> list[str]:
    if not report["loops"]:
        return []
    return ["## Static loops of 10 mm", "", *table(
        ["object", "method", "most gained, uJ", "median, uJ", "loops"],
        [[row["object"], row["method"], f"{1e6 * row['gained_j']:.3g}",
          f"{1e6 * row['median_j']:.3g}", str(row["loops"])] for row in report["loops"]])]


def target_lines(report: dict) -> list[str]:
    return ["## Targets", "", *table(
        ["what", "measured", "floor", "goal", "met", "decided by"],
        [[row["target"] + (f", {row['unit']}" if row["unit"] else ""), f"{row['value']:.4g}",
          f"{row['floor']:g}", f"{row['goal']:g}",
          "goal" if row["meets_goal"] else "floor" if row["meets_floor"] else "no", row["worst"]]
         for row in report["targets"]])]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("report", help="JSON that spm-bench stability printed")
    arguments = parser.parse_args()
    with open(arguments.report, encoding="utf-8") as file:
        report = json.load(file)
    if not report.get("cases"):
        sys.exit(f"{arguments.report}: no cases; give what spm-bench stability --json printed")
    lines = ["# Where methods fail, measured", "",
             "`spm-bench stability`: the cases, the judges and the profiles are told in "
             "[the laboratory's page](../../stability/README.md).", ""]
    lines += target_lines(report) + failing_lines(report) + verdict_lines(report)
    lines += border_lines(report) + theory_lines(report) + loop_lines(report)
    print("\n".join(lines).rstrip())
    return 0


if __name__ == "__main__":
    sys.exit(main())
