# SPDX-License-Identifier: Apache-2.0
"""The tables about tools with six degrees of freedom: what scenes felt, which scripts/tool_scenes runs,
and what a tick takes and how far it is off, by spm-bench sixdof."""

from markdown_table import number, table

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


def sixdof_lines(report: dict) -> list[str]:
    """One row a method, setting and path."""
    def errors(of: dict | None) -> str:
        return " / ".join(number(of[key]) for key in ("median", "p95", "p99")) if of else ""

    return table(["path", "method", "settings", "a tick p50 / p99, us", "ended coarser, %",
                  "force off, median / p95 / p99, %", "torque off, median / p95 / p99, %",
                  "off the finest level: force, %", "torque, %",
                  "direction off, median / p95 / p99, deg", "kB"],
                 [[row["path"], f"`{row['method']}`", row["settings"],
                   f"{row['p50_us']:.0f} / {row['p99_us']:.0f}",
                   f"{100 * row['degraded']:.1f}", errors(row["force_error_percent"]),
                   errors(row["torque_error_percent"]), errors(row["finest_force_error_percent"]),
                   errors(row["finest_torque_error_percent"]), errors(row["direction_error_deg"]),
                   f"{row['bytes'] / 1e3:,.0f}" if row["bytes"] else ""]
                  for row in report["rows"]])
