# SPDX-License-Identifier: Apache-2.0
"""What `spm-bench tables --json` measured as Markdown: the paper's Tables 1 to 3."""

from markdown_table import table

SLIDES = {2: "Table 2: Galeon", 3: "Table 3: Teeth"}


def size(count: int) -> str:
    return f"{count / 1e3:,.0f} kB" if count < 1e7 else f"{count / 1e6:,.1f} MB"


def number(value: float) -> str:
    return f"{value:.3g}" if value < 1000 else f"{value:,.0f}"


def search(row: dict) -> str:
    return "with" if row["with_collision_detection"] else "without"


def slide_lines(report: dict, which: int) -> list[str]:
    rows = [row for row in report["rows"] if row["table"] == which]
    if not rows:
        return []
    lines = ["", f"## {SLIDES[which]}, {rows[0]['triangles']:,} triangles", ""]
    return lines + table(
        ["process", "method", "collision detection", "mean (sd), us", "p50 / p99, us", "ticks",
         "in contact", "bytes", "the paper, mean (sd), us"],
        [[row["process"], f"`{row['method']}`, {row['settings']}", search(row),
          f"{number(row['mean_us'])} ({number(row['sd_us'])})",
          f"{number(row['p50_us'])} / {number(row['p99_us'])}", f"{row['ticks']:,}",
          f"{row['contact_ticks']:,}", size(row["bytes"]),
          "" if row["paper_mean_us"] is None else
          f"{number(row['paper_mean_us'])} ({number(row['paper_sd_us'])})"] for row in rows])


def series(report: dict, over: str) -> list[tuple[dict, list[dict]]]:
    """What grew, and its rows in the order of what it grew with."""
    first = [row for row in report["rows"] if row["table"] == 1]
    least = min(row["triangles"] for row in first)
    found = []
    for growth in report["growth"]:
        if growth["over"] != over:
            continue
        rows = [row for row in first if row["method"] == growth["method"] and
                row["with_collision_detection"] == growth["with_collision_detection"] and
                (row["planes"] is not None and row["triangles"] == least if over == "planes"
                 else row["settings"] == growth["settings"])]
        found.append((growth, sorted(rows, key=lambda row: row[over])))
    return found


def growth_lines(report: dict, over: str) -> list[str]:
    found = series(report, over)
    if not found:
        return []
    counts = sorted({row[over] for _, rows in found for row in rows})
    head = ["method", "collision detection", *(f"{count:,} {over}" for count in counts), "grows as"]
    lines = ["", f"Mean time of a force in us, and bytes, over the number of {over}:", ""]
    body = []
    for growth, rows in found:
        by_count = {row[over]: row for row in rows}
        cells = [f"{number(by_count[count]['mean_us'])} ({size(by_count[count]['bytes'])})"
                 if count in by_count else "" for count in counts]
        name = f"`{growth['method']}`" + (f", {growth['settings']}" if growth["settings"] else "")
        body.append([name, search(growth), *cells, f"n^{growth['exponent']:.2f}"])
    return lines + table(head, body)


def paper_tables(report: dict) -> list[str]:
    """Lines from the heading of Table 1 on."""
    lines = ["## Table 1: growth, measured on a bumpy sphere"]
    lines += growth_lines(report, "triangles") + growth_lines(report, "planes")
    for which in SLIDES:
        lines += slide_lines(report, which)
    return lines
