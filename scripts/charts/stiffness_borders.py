# SPDX-License-Identifier: Apache-2.0
"""Where devices begin to shake, from what `spm-bench stability --json` measured, and the stiffness that
`auto` stands for."""

import re
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent.parent
PROFILES = SOURCE / "common/base/device_profile.hpp"
STIFFNESS = SOURCE / "common/contact/stable_stiffness.hpp"
HOLD, TAP = "flat-wall", "tap-at-500-mm-s"
# Of another delay, encoder or sensor, or a wall that switches, than the profile's.
OTHER_DEVICE = {"delay-2-ticks", "delay-4-ticks", "encoder-100um", "noisy-flat-wall",
                "tile-switched-wall"}


def caps() -> dict[str, float]:
    """Each profile's largest rated stiffness, N/m."""
    rows = re.findall(r'^    \{"(\w+)", [^,]+, [^,]+, ([0-9.e+]+), \{', PROFILES.read_text(encoding="utf-8"),
                      re.MULTILINE)
    return {name: float(cap) for name, cap in rows}


def margin() -> float:
    return float(re.search(r"stiffness_margin = ([0-9.]+);", STIFFNESS.read_text(encoding="utf-8"))[1])


def cases(report: dict) -> list[str]:
    return sorted({row["case"] for row in report["borders"] if row["degrees"] == 3})


def border(report: dict, case: str, method: str, device: str) -> float:
    found = [row["border_n_m"] for row in report["borders"]
             if row["degrees"] == 3
             and (row["case"], row["method"], row["device"]) == (case, method, device)]
    if len(found) != 1:
        raise SystemExit(f"error: the stability report has {len(found)} borders of {method} in {case} on "
                         f"{device} instead of one; measure anew with scripts/measure --only stability")
    return found[0]


def of_profile(report: dict, device: str) -> tuple[float, float, float]:
    """Of the bare proxy on a wall, held and hit, and the least of the default in any other case, N/m."""
    served = min(border(report, case, "default", device)
                 for case in cases(report) if case not in OTHER_DEVICE)
    return border(report, HOLD, "proxy", device), border(report, TAP, "proxy", device), served


def chosen(report: dict, device: str) -> float:
    """What `auto` stands for, N/m."""
    hold, tap, _ = of_profile(report, device)
    return min(margin() * min(round(hold), round(tap)), caps()[device])
