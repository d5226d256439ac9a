#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Unplugs and plugs in again an emulated WoodenHaptics and an emulated Falcon, below the real
hidapi and libusb, while the daemon runs and records; tells from the recording how many ticks the
force outlived the device, and how often it came back.

The emulated device notes when it was unplugged (CLOCK_MONOTONIC); the recording's tick 0 is placed
on the same clock by what the daemon tells applications. 1 means that the next tick that was due had
no force any more: a thread of the daemon waits for reports, is woken up by the loss itself, and
leaves word for the loop (servo/devices/base/port_threads.hpp).
"""

import argparse
import json
import os
import random
import signal
import sys
import time

from soak_tools import (HOME, PATIENCE, Client, Daemon, Folder, Row, TickClock, add_common_options,
                        baked_box, below, cores_of, percentile, program, read_recording, show,
                        start_of_grid, write_scene)

STIFFNESS = 300.0  # N/m
INSIDE = 0.02  # m, that the box's top is above the tool: wherever it goes, there is a force to lose
REPORTS = 150  # that a device sends before it is unplugged again
GONE_MS = 50  # that it stays unplugged
FIRMWARE_BYTES = 4096
SPARE = 3  # cycles of the Falcon beyond those that are counted
SLOWEST_CYCLE = 3.0  # s, on any machine
ON = "none"  # the cause of a force that is not off


def wooden(folder: str) -> tuple[list[str], str, tuple[float, float, float]]:
    """Command of the emulated device, the daemon's option, and where the tool is about."""
    seen = os.path.join(folder, "device.json")
    mock = [program("mock_hid"), "wooden-v2", f"unplug={REPORTS}:{GONE_MS}", f"report={seen}"]
    return mock, "woodenhaptics:home_confirmed=always,signs=+++", HOME


def falcon(folder: str, cycles: int) -> tuple[list[str], str, tuple[float, float, float]]:
    firmware = os.path.join(folder, "firmware.bin")
    with open(firmware, "wb") as file:
        file.write(b"\xaa\x08" + random.Random(1).randbytes(FIRMWARE_BYTES - 2))
    mock = [program("mock_usb_falcon"), "--mode", "replug", "--firmware-size", str(FIRMWARE_BYTES),
            "--act-after", str(REPORTS), "--replug-ms", str(GONE_MS), "--times",
            str(cycles + SPARE)]
    return mock, f"falcon:firmware={firmware}", (0.0, 0.0, 0.0)


def wait_for_recoveries(daemon: Daemon, cycles: int) -> None:
    """Until the device was lost and found so many times, or for as long as that may take."""
    deadline = time.monotonic() + PATIENCE + cycles * SLOWEST_CYCLE
    found, was_on = 0, False
    with Client(path=daemon.socket, timeout=PATIENCE) as client:
        is_lost = False
        while found < cycles and time.monotonic() < deadline and daemon.is_alive():
            device = client.device(0)
            is_on = device.cause == 0
            is_lost = is_lost or (was_on and not device.connected)
            if is_lost and is_on:
                found, is_lost = found + 1, False
            was_on = was_on or is_on
            time.sleep(0.004)


def outages(rows: list[Row]) -> list[tuple[int, int | None]]:
    """Places in `rows` where the device was first found gone, and where the force was on again."""
    list_of_them: list[tuple[int, int | None]] = []
    begin = None
    for i, row in enumerate(rows):
        if begin is None and row.cause == "device_gone" and i > 0:
            begin = i
        elif begin is not None and row.cause == ON:
            list_of_them.append((begin, i))
            begin = None
    return list_of_them + ([(begin, None)] if begin is not None else [])


def force_while_off(rows: list[Row]) -> int:
    """Ticks that sent a force although it was said to be off."""
    return sum(row.cause != ON and row.size > 0 for row in rows)


def ticks_to_zero(rows: list[Row], start: float, rate: float, unplugged_ns: int) -> tuple[int, int]:
    """From the tick that was last due before a moment to the first without force: ticks of the time
    grid, and those of them that ran, as a stalled machine runs none."""
    last_due = int((unplugged_ns - start) * rate / 1e9)
    later = [row for row in rows if row.tick >= last_due]
    first = next(i for i, row in enumerate(later) if row.cause != ON)
    ran = sum(row.tick > last_due for row in later[:first + 1])
    return later[first].tick - last_due, ran


def run_cycles(name: str, cycles: int, cores: set[int] | None, folder: str) -> dict:
    """Runs a device through its cycles: the daemon's report, the rows, and what the device saw."""
    asset, half_height = baked_box()
    mock, device, tool = wooden(folder) if name == "woodenhaptics" else falcon(folder, cycles)
    above = (tool[0], tool[1] + INSIDE, tool[2])
    scene = write_scene(os.path.join(folder, "scene.toml"), asset, [below(above, half_height)],
                        STIFFNESS)
    recording = os.path.join(folder, "run.spmrec")
    daemon = Daemon(folder, "--scene", scene, "--device", device, "--record", recording, mock=mock,
                    cores=cores)
    clock = TickClock(daemon.socket)
    sample = clock.now()
    clock.close()
    try:
        wait_for_recoveries(daemon, cycles)
        os.kill(daemon.pid, signal.SIGTERM)
        report = daemon.finish(PATIENCE)
    finally:
        daemon.kill()
    seen = os.path.join(folder, "device.json")
    if os.path.exists(seen):
        with open(seen, encoding="utf-8") as file:
            told = json.load(file)
    else:
        told = json.loads(daemon.told().splitlines()[-1])
    rate, rows = read_recording(recording)
    return {"report": report, "device": told, "rows": rows, "rate_hz": rate,
            "start_ns": start_of_grid(sample, rate, rows)}


def how_often(counts: list[int]) -> dict[str, int]:
    return {str(count): counts.count(count) for count in sorted(set(counts))}


def measure(name: str, cycles: int, cores: set[int] | None) -> dict:
    with Folder() as folder:
        run = run_cycles(name, cycles, cores, folder)
    rows, rate, start = run["rows"], run["rate_hz"], run["start_ns"]
    found = outages(rows)
    recovered = [(begin, end) for begin, end in found if end is not None][:cycles]
    unplugged = run["device"]["unplugged_ns"][:len(recovered)]
    ticks = [ticks_to_zero(rows[max(0, begin - int(rate)):], start, rate, at)
             for (begin, _), at in zip(recovered, unplugged)]
    back = [(rows[end].tick / rate * 1e9 + start - at) * 1e-6
            for (_, end), at in zip(recovered, run["device"]["plugged_in_ns"])]
    return {"device": name, "cycles": cycles, "outages": len(found), "recoveries": len(recovered),
            "ticks_to_zero": how_often([grid for grid, _ in ticks]),
            "ticks_run_to_zero": how_often([ran for _, ran in ticks]),
            "ticks_with_force_while_off": force_while_off(rows),
            "back_ms": {"p50": percentile(back, 0.5), "max": max(back, default=0.0)},
            "missed": run["report"]["missed"], "ticks": run["report"]["ticks"],
            "page_faults": run["report"]["page_faults"],
            "busy_us": run["report"]["busy_us"], "reopened":
            run["report"]["devices"][0]["reopened"]}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cycles", type=int, default=100)
    parser.add_argument("--device", choices=("woodenhaptics", "falcon"), action="append",
                        help="may be repeated (default: both)")
    add_common_options(parser)
    arguments = parser.parse_args()
    found = [measure(name, arguments.cycles, cores_of(arguments.cores))
             for name in arguments.device or ("woodenhaptics", "falcon")]
    columns = [("device", "device"), ("cycles", "cycles"), ("recoveries", "recoveries"),
               ("ticks from unplugging to zero force: how often", "ticks_to_zero"),
               ("of them run", "ticks_run_to_zero"),
               ("ticks with force while off", "ticks_with_force_while_off"),
               ("force back after plugging in, ms", "back_ms"), ("ticks", "ticks"),
               ("missed", "missed"), ("page faults", "page_faults")]

    def cell(value):
        if not isinstance(value, dict):
            return value
        return ", ".join(f"{key}: {item:.1f}" if isinstance(item, float) else f"{key}: {item}"
                         for key, item in value.items())

    show(arguments.out, "Unplugged and plugged in again", [title for title, _ in columns],
         [[cell(result[key]) for _, key in columns] for result in found], {"devices": found})
    return 0


if __name__ == "__main__":
    sys.exit(main())
