# SPDX-License-Identifier: Apache-2.0
"""A table in Markdown, for the pages that measurements are written to."""

import math


def table(head: list[str], rows: list[list[str]]) -> list[str]:
    """Lines: the head, a rule and a line a row."""
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return lines + ["| " + " | ".join(row) + " |" for row in rows]


def number(value: float) -> str:
    """Two significant digits, and from 100 on all before the point."""
    if isinstance(value, int) or abs(value) >= 99.5 or value == 0:
        return f"{value:,.0f}"
    magnitude = math.floor(math.log10(abs(float(f"{value:.1e}"))))
    return f"{value:.{max(0, 1 - magnitude)}f}"
