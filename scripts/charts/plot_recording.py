#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws a recording of spm-servo (run --record, or a black box): the force that the law wanted and
the one that was sent, the torque where there is any, depth, how busy the loop was, and where the force
was off, with its cause. --from and --to draw a part of it.
Writes PREFIX.svg and PREFIX.png; equal input gives equal bytes.

Needs matplotlib, Debian package python3-matplotlib: run it with /usr/bin/python3.
"""

import sys

from chart_io import chart_parser
from chart_style import save
from recording_file import FORCE_CAPPED, TORQUE_CAPPED, RecordingError, read_recording

import matplotlib

matplotlib.rcParams["font.size"] = 10

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

WANTED_COLOUR, SENT_COLOUR, DEPTH_COLOUR = "#8a8a8a", "#b5302a", "#1f5f8b"
ADDED_COLOUR = "#2f7d4f"


def shade_causes(axes, time: np.ndarray, rows: np.ndarray, causes: list[str], named: bool) -> None:
    """Grey where the force was off; the cause is written where each stretch begins."""
    cause = rows["cause"]
    edges = np.flatnonzero(np.diff(cause)) + 1
    for first, last in zip(np.r_[0, edges], np.r_[edges, len(cause)]):
        if cause[first] == 0:
            continue
        end = time[min(last, len(time) - 1)]
        axes.axvspan(time[first], end, color="#000000", alpha=0.08, linewidth=0)
        if named and end - time[first] > 0.01 * (time[-1] - time[0]):
            axes.text(time[first], 0.98, " " + causes[cause[first]],
                      transform=axes.get_xaxis_transform(), va="top", fontsize=9)


def explain(axes) -> None:
    """The legend beside the title, where it covers no line."""
    axes.legend(loc="lower right", bbox_to_anchor=(1, 1), borderaxespad=0, ncol=4, frameon=False)


def draw_size(axes, time: np.ndarray, rows: np.ndarray, suffix: str, cap: int) -> None:
    """The size of what was wanted, sent and added, and where what was sent met its cap."""
    for name, colour, width in (("wanted", WANTED_COLOUR, 2.2), ("sent", SENT_COLOUR, 1.0)):
        axes.plot(time, np.linalg.norm(rows[name + suffix], axis=1), color=colour, linewidth=width,
                  label=name)
    if rows["added" + suffix].any():
        axes.plot(time, np.linalg.norm(rows["added" + suffix], axis=1), color=ADDED_COLOUR,
                  linewidth=1.0, label="added by applications")
    met = (rows["flags"] & cap) != 0
    if met.any():
        axes.plot(time[met], np.linalg.norm(rows["sent" + suffix][met], axis=1), ".", color=SENT_COLOUR,
                  markersize=3, label="at its cap")
    explain(axes)
    axes.set_ylim(bottom=0)


def draw(header: dict, rows: np.ndarray, device: int, prefix: str) -> None:
    time = rows["tick"] / header["rate_hz"]
    turns = any(rows[name].any() for name in ("wanted_torque", "added_torque", "sent_torque"))
    figure, panels = plt.subplots(4 if turns else 3, 1, figsize=(11, 9 if turns else 7), sharex=True,
                                  constrained_layout=True)
    force, depth, busy = panels[0], panels[-2], panels[-1]
    draw_size(force, time, rows, "", FORCE_CAPPED)
    force.set_title(f"Force on the hand: {header['devices'][device]['name']} "
                    "(grey ground: off, and why)")
    force.set_ylabel("N")
    if turns:
        draw_size(panels[1], time, rows, "_torque", TORQUE_CAPPED)
        panels[1].set_title("Torque on the hand, about its position")
        panels[1].set_ylabel("N m")
    depth.plot(time, rows["depth"] * 1e3, color=DEPTH_COLOUR, linewidth=1.0)
    depth.set_title("Depth below the surface")
    depth.set_ylabel("mm")
    busy.plot(time, rows["wake_ns"] * 1e-3, color=WANTED_COLOUR, linewidth=0.6, label="woke up late")
    busy.plot(time, rows["busy_ns"] * 1e-3, color=SENT_COLOUR, linewidth=0.6, label="worked")
    busy.axhline(1e6 / header["rate_hz"], color="#000000", linewidth=0.6, linestyle=":")
    busy.set_yscale("symlog", linthresh=1)
    busy.set_ylim(bottom=0)
    busy.set_title("The loop (dotted: a tick)")
    busy.set_ylabel("us")
    busy.set_xlabel("time, s")
    explain(busy)
    for axes in panels:
        shade_causes(axes, time, rows, header["causes"], named=axes is force)
        axes.set_xlim(time[0], max(time[-1], time[0] + 1e-3))
    save(figure, prefix)


def main() -> int:
    parser = chart_parser(__doc__)
    parser.add_argument("recording", help="file that spm-servo wrote")
    parser.add_argument("--device-number", type=int, default=0, help="counted from 0 (default 0)")
    parser.add_argument("--from", dest="first", type=float, default=-np.inf, metavar="SECONDS",
                        help="leave out what was before, by the axis of time")
    parser.add_argument("--to", dest="last", type=float, default=np.inf, metavar="SECONDS",
                        help="leave out what came after, by the axis of time")
    arguments = parser.parse_args()
    try:
        recording = read_recording(arguments.recording)
    except RecordingError as problem:
        sys.exit(str(problem))
    header, rows = recording.header, np.frombuffer(recording.content, recording.dtype())
    rows = rows[rows["device"] == arguments.device_number]
    if len(rows) == 0:
        sys.exit(f"{arguments.recording}: has no row of device {arguments.device_number}; it is of "
                 f"{len(header['devices'])}, counted from 0")
    time = rows["tick"] / header["rate_hz"]
    begun, ended = time[0], time[-1]
    rows = rows[(time >= arguments.first) & (time <= arguments.last)]
    if len(rows) == 0:
        sys.exit(f"{arguments.recording}: has no tick from --from to --to; it is from {begun:g} s to "
                 f"{ended:g} s")
    draw(header, rows, arguments.device_number, arguments.prefix)
    return 0


if __name__ == "__main__":
    sys.exit(main())
