# SPDX-License-Identifier: Apache-2.0
"""The table of what the scenes with a tool felt, which scripts/tool_scenes runs."""

from markdown_table import table

HEADINGS = ["scene", "profile", "s", "ticks missed", "a tick p50 / p99, us",
            "ticks on a coarser level / short of time, %", "largest force, N / ticks at the cap, %",
            "largest torque, mN m", "hand's depth, mm", "forces replayed / that differ"]


def scene_lines(report: dict) -> list[str]:
    """One row a scene."""
    return table(HEADINGS, [cells(row) for row in report["scenes"]])


def cells(row: dict) -> list[str]:
    def share(key: str) -> str:
        return f"{100 * row[key] / row['ticks']:.1f}"

    times = row["tick_us"]
    return [f"`{row['scene']}`", f"`{row['profile']}`", f"{row['seconds']:.0f}", f"{row['missed_ticks']:,}",
            f"{times['p50']:.0f} / {times['p99']:.0f}",
            f"{share('coarse_ticks')} / {share('short_of_time_ticks')}",
            f"{row['force_max_n']:.1f} / {share('force_cap_ticks')}",
            f"{1e3 * row['torque_max_n_m']:.0f}", f"{1e3 * row['depth_max_m']:.1f}",
            f"{row['compared_forces']:,} / {row['differing_forces']:,}"]
