#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws a recording of spm-servo (run --record, or a black box): the force that the law wanted and
the one that was sent, depth, how busy the loop was, and where the force was off, with its cause.
Writes PREFIX.svg and PREFIX.png; equal input gives equal bytes.

Needs matplotlib, Debian package python3-matplotlib: run it with /usr/bin/python3.
"""

import json
import struct
import sys

from chart_io import chart_parser
from chart_style import save

import matplotlib

matplotlib.rcParams["font.size"] = 10

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

MAGIC, FORM, ROW_KIND = b"SPM-REC1", 4, 1
# formats/motion/recording.hpp
ROW = np.dtype([("tick", "<u8"), ("position", "<f8", 3), ("wanted", "<f8", 3), ("added", "<f8", 3),
                ("sent", "<f8", 3), ("depth", "<f8"), ("wake_ns", "<i4"), ("busy_ns", "<i4"),
                ("buttons", "<u4"), ("device", "<u2"), ("cause", "u1"), ("flags", "u1"),
                ("first", "<u2"), ("exact", "<u2"), ("held", "<u2"), ("shortened", "<u2")])
WANTED_COLOUR, SENT_COLOUR, DEPTH_COLOUR = "#8a8a8a", "#b5302a", "#1f5f8b"
ADDED_COLOUR = "#2f7d4f"


def read_recording(path: str) -> tuple[dict, np.ndarray]:
    try:
        with open(path, "rb") as file:
            content = file.read()
    except OSError as problem:
        sys.exit(f"{path}: {problem.strerror}; give a recording of spm-servo run --record")
    if content[:8] != MAGIC or len(content) < 32:
        sys.exit(f"{path}: is no recording; give one of spm-servo run --record")
    size = int.from_bytes(content[8:12], "little")
    header = json.loads(content[16:16 + size])
    if header.get("form") != FORM or header["row_bytes"] != ROW.itemsize:
        sys.exit(f"{path}: is of another form; draw it with the spm-servo that recorded it")
    rows, at, end = [], 16 + size, len(content) - 16
    while at + 8 <= end:
        kind, part = struct.unpack_from("<2I", content, at)
        at += 8
        if kind == ROW_KIND:
            rows.append(content[at:at + part])
        at += part
    if at != end:
        sys.exit(f"{path}: was cut short; record it again")
    return header, np.frombuffer(b"".join(rows), ROW)


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


def draw(header: dict, rows: np.ndarray, device: int, prefix: str) -> None:
    time = rows["tick"] / header["rate_hz"]
    figure, (force, depth, busy) = plt.subplots(3, 1, figsize=(11, 7), sharex=True,
                                                constrained_layout=True)
    for name, colour, width in (("wanted", WANTED_COLOUR, 2.2), ("sent", SENT_COLOUR, 1.0)):
        force.plot(time, np.linalg.norm(rows[name], axis=1), color=colour, linewidth=width,
                   label=name)
    if rows["added"].any():
        force.plot(time, np.linalg.norm(rows["added"], axis=1), color=ADDED_COLOUR, linewidth=1.0,
                   label="added by applications")
    force.legend(loc="lower left", frameon=False)
    force.set_title(f"Force on the hand: {header['devices'][device]['name']} "
                    "(grey ground: off, and why)")
    force.set_ylabel("N")
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
    busy.legend(loc="upper right", frameon=False)
    for axes in (force, depth, busy):
        shade_causes(axes, time, rows, header["causes"], named=axes is force)
        axes.set_xlim(time[0], max(time[-1], time[0] + 1e-3))
    force.set_ylim(bottom=0)
    save(figure, prefix)


def main() -> int:
    parser = chart_parser(__doc__)
    parser.add_argument("recording", help="file that spm-servo wrote")
    parser.add_argument("--device-number", type=int, default=0, help="counted from 0 (default 0)")
    arguments = parser.parse_args()
    header, rows = read_recording(arguments.recording)
    rows = rows[rows["device"] == arguments.device_number]
    if len(rows) == 0:
        sys.exit(f"{arguments.recording}: has no row of device {arguments.device_number}; it is of "
                 f"{len(header['devices'])}, counted from 0")
    draw(header, rows, arguments.device_number, arguments.prefix)
    return 0


if __name__ == "__main__":
    sys.exit(main())
