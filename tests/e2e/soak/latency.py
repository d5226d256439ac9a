#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the time from a device's report to the force command that answers it: an emulated
WoodenHaptics steps into a box and out of it, and notes when it sent the first report of a step and
when the first command came whose currents agree with it. The recording tells how the time between
was spent. A program without a loop that answers each report at once (ping_hid) tells what the
emulation and hidapi take of it.

A second table is of every kind of device: what the daemon itself measured of each report, from its
coming to the command's leaving (report_to_command of its report), and from the coming to the loop
(report_age). Each is driven over its emulation, `external` by its example process.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

from soak_tools import (HOME, PATIENCE, Daemon, Folder, Row, Table, TickClock, add_common_options,
                        baked_box, below, cores_of, percentile, program, read_recording, show,
                        start_of_grid, write_scene)

STIFFNESS = 1000.0  # N/m
COUNTS = 15  # of the third encoder to each side of home: about a millimetre
EVERY = 20  # reports between two steps at least, and as many again at random
SETTLED = 0.5  # s, after which the force is no longer faded in
# A positive count of the third encoder brings the tool down, into the box, in every protocol.
OPTIONS = "home_confirmed=always,signs=---,motor_signs=+++"
TICKS_SEARCHED = 20  # in which a step must show
EXTERNAL = "latency"  # its name
NO_COMMAND = {"spacemouse": "no command leaves: it moves the tool, and gives no force",
              "sim": "no command leaves: the plant is computed in the tick"}


def mock(device: str, seen: str, *faults: str) -> list[str]:
    return [program("mock_hid"), device, f"step={COUNTS}:{EVERY}", f"report={seen}", *faults]


def steps_seen(path: str) -> list[tuple[int, int, bool]]:
    """When a step was reported and answered, ns, and whether it led into the box."""
    with open(path, encoding="utf-8") as file:
        return [(step["reported_ns"], step["answered_ns"], step["inwards"])
                for step in json.load(file)["steps"]]


def ping(device: str, steps: int, folder: str) -> list[float]:
    """Microseconds from report to answer without a loop."""
    seen = os.path.join(folder, "ping.json")
    subprocess.run([*mock(device, seen, f"until={steps * EVERY * 3 // 2}"), "--",
                    program("ping_hid"), OPTIONS], check=True, timeout=PATIENCE * 4,
                   stdout=subprocess.DEVNULL)
    return [(answered - reported) * 1e-3 for reported, answered, _ in steps_seen(seen)[10:]]


def felt_in(rows: dict[int, Row], due: int, inwards: bool) -> Row | None:
    """The tick that first knew of a step that was reported before tick `due`."""
    for tick in range(due, due + TICKS_SEARCHED):
        row = rows.get(tick)
        if row is not None and row.contact == inwards:
            return row
    return None


def run_loop(device: str, seconds: float, rate: float, cores: set[int] | None,
             folder: str) -> tuple[dict, list[dict]]:
    """The daemon's report, and of each step how its time was spent, us."""
    asset, half_height = baked_box()
    scene = write_scene(os.path.join(folder, "scene.toml"), asset, [below(HOME, half_height)],
                        STIFFNESS)
    seen, recording = os.path.join(folder, "device.json"), os.path.join(folder, "run.spmrec")
    daemon = Daemon(folder, "--scene", scene, "--device", "woodenhaptics:" + OPTIONS, "--rate",
                    str(rate), "--record", recording, mock=mock(device, seen), cores=cores)
    clock = TickClock(daemon.socket)
    sample = clock.now()
    clock.close()
    time.sleep(seconds)
    report = daemon.stop()
    _, listed = read_recording(recording)
    start, period = start_of_grid(sample, rate, listed), 1e9 / rate
    rows = {row.tick: row for row in listed}
    spent = []
    for reported, answered, inwards in steps_seen(seen):
        if reported < start + SETTLED * 1e9:
            continue
        row = felt_in(rows, int((reported - start) / period) + 1, inwards)
        if row is None:
            continue
        due = start + row.tick * period
        spent.append({"total": (answered - reported) * 1e-3, "wait": (due - reported) * 1e-3,
                      "wake": row.wake_ns * 1e-3, "busy": row.busy_ns * 1e-3,
                      "out": (answered - due - row.wake_ns - row.busy_ns) * 1e-3})
    return report, spent


STAGES = (("from the report to the tick that felt it: emulation, hidapi, receiving thread, and "
           "mostly the clock", "wait"), ("the loop wakes up", "wake"),
          ("the tick: query, force, safety", "busy"),
          ("from the tick's end to the device: sending thread, hidapi, emulation", "out"),
          ("all: from a report to the force that answers it", "total"))


@contextmanager
def beside(name: str, folder: str, seconds: float) -> Iterator[None]:
    """What drives a device beside the daemon: the process of `external`."""
    if name != "external":
        yield
        return
    process = subprocess.Popen([program("external_example"), EXTERNAL, str(seconds + 1),
                                *map(str, HOME)], env={**os.environ, "XDG_RUNTIME_DIR": folder},
                               stdout=subprocess.DEVNULL)
    try:
        yield
    finally:
        process.kill()
        process.wait()


def devices(folder: str) -> dict[str, tuple[list[str], str]]:
    """Of each kind the command of its emulation, and the daemon's option."""
    hid = program("mock_hid")
    report = f"report={os.path.join(folder, 'device.json')}"
    return {"falcon": ([program("mock_usb_falcon"), "--mode", "running"], "falcon"),
            **{f"woodenhaptics V{number}": ([hid, f"wooden-v{number}", report],
                                            f"woodenhaptics:protocol=v{number},signs=+++,"
                                            "home_confirmed=always")
               for number in (1, 2, 3)},
            "pid": ([hid, "pid", report], "pid:full_force=4N"),
            "external": ([], f"external:name={EXTERNAL}"),
            "spacemouse": ([hid, "spacemouse", report], "spacemouse"),
            "sim": ([], "sim")}


def run_device(name: str, seconds: float, rate: float, cores: set[int] | None) -> dict:
    """What the daemon measured of a device, us; nothing of what the device has not."""
    asset, half_height = baked_box()
    with Folder() as folder:
        mocked, option = devices(folder)[name]
        middle = HOME if name.startswith(("woodenhaptics", "external")) else (0.0, 0.0, 0.0)
        scene = write_scene(os.path.join(folder, "scene.toml"), asset, [below(middle, half_height)],
                            STIFFNESS)
        daemon = Daemon(folder, "--scene", scene, "--device", option, "--rate", str(rate),
                        mock=mocked, cores=cores)
        with beside(name, folder, seconds):
            time.sleep(seconds)
            report = daemon.stop()
    found = report["devices"][0]
    return {"device": name, "rate_hz": rate, "ticks": report["ticks"], "missed": report["missed"],
            "latency_us": found.get("latency_us", {}), "no_command": NO_COMMAND.get(name, "")}


def row_of(found: dict) -> list:
    latency = found["latency_us"]
    age = latency.get("report_age", {})
    whole = {} if found["no_command"] else latency["report_to_command"]
    return [found["device"], *(whole.get(key, "") for key in ("p50", "p99", "max")),
            *(age.get(key, "") for key in ("p50", "p99")), found["missed"], found["no_command"]]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=20)
    parser.add_argument("--rate", type=float, default=1000, help="Hz (default 1000)")
    parser.add_argument("--device", action="append",
                        choices=("wooden-v1", "wooden-v2", "wooden-v3"),
                        help="may be repeated (default: wooden-v1, which sends by itself, and "
                        "wooden-v2, which answers commands)")
    add_common_options(parser)
    arguments = parser.parse_args()
    found, rows = [], []
    for device in arguments.device or ("wooden-v1", "wooden-v2"):
        with Folder() as folder:
            report, spent = run_loop(device, arguments.seconds, arguments.rate,
                                     cores_of(arguments.cores), folder)
            alone = ping(device, max(50, len(spent)), folder)
        stages = {key: {"p50": percentile([step[key] for step in spent], 0.5),
                        "p99": percentile([step[key] for step in spent], 0.99)}
                  for _, key in STAGES}
        baseline = {"p50": percentile(alone, 0.5), "p99": percentile(alone, 0.99)}
        share = baseline["p50"] / stages["total"]["p50"] if spent else 0.0
        found.append({"device": device, "rate_hz": arguments.rate, "steps": len(spent),
                      "stages_us": stages, "ping_us": baseline, "pings": len(alone),
                      "share_of_emulation_p50": share, "missed": report["missed"],
                      "ticks": report["ticks"]})
        rows += [[device, name, stages[key]["p50"], stages[key]["p99"]] for name, key in STAGES]
        rows += [[device, "without a loop: emulation and hidapi both ways", baseline["p50"],
                  baseline["p99"]],
                 [device, f"its share of all, % ({len(spent)} steps)", 100 * share, ""]]
    measured = [run_device(name, arguments.seconds, arguments.rate, cores_of(arguments.cores))
                for name in devices("")]
    show(arguments.out, f"From a report to the force that answers it, {arguments.rate:g} Hz",
         ["device", "what", "p50, us", "p99, us"], rows, {"devices": found, "all": measured},
         Table("What the daemon measured of every kind of device, from a report's coming to the "
               "command's leaving:",
               ["device", "p50, us", "p99, us", "max, us", "of it until the loop: p50, us",
                "p99, us", "missed ticks", ""], [row_of(result) for result in measured]))
    answered = all(result["no_command"] or result["latency_us"]["report_to_command"]["p50"] > 0
                   for result in measured)
    return 0 if answered and all(result["steps"] > 0 for result in found) else 1


if __name__ == "__main__":
    sys.exit(main())
