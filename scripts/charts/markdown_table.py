# SPDX-License-Identifier: Apache-2.0
"""A table in Markdown, for the pages that measurements are written to."""


def table(head: list[str], rows: list[list[str]]) -> list[str]:
    """Lines: the head, a rule and a line a row."""
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return lines + ["| " + " | ".join(row) + " |" for row in rows]
