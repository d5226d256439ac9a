#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Starts a daemon on the simulated device and measures how long an application takes to read its
state with libspm_client (client_reads), while the loop publishes."""

import argparse
import json
import os
import subprocess
import sys

from soak_tools import (PATIENCE, Daemon, Folder, add_common_options, baked_box, cores_of, program,
                        show, write_scene)

STIFFNESS = 500.0  # N/m


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--reads", type=int, default=1_000_000)
    add_common_options(parser)
    arguments = parser.parse_args()
    with Folder() as folder:
        asset, _ = baked_box()
        scene = write_scene(os.path.join(folder, "scene.toml"), asset, [(0.0, 0.0, 0.0)], STIFFNESS)
        daemon = Daemon(folder, "--scene", scene, "--device", "sim",
                        cores=cores_of(arguments.cores))
        try:
            done = subprocess.run([program("client_reads"), daemon.socket, str(arguments.reads)],
                                  check=True, capture_output=True, text=True, timeout=PATIENCE * 10)
            report = daemon.stop()
        finally:
            daemon.kill()
    found = json.loads(done.stdout)
    found["daemon"] = {"ticks": report["ticks"], "missed": report["missed"]}
    rows = [[one["what"], one["batch"], one["reads"], one["busy"], one["p50_ns"], one["p99_ns"],
             one["max_ns"]] for one in found["measured"]]
    show(arguments.out, "An application reads the state "
         f"(clock_gettime, {found['clock_ns']:.1f} ns, taken off)",
         ["what", "reads a batch", "reads", "refused as busy", "p50, ns a read", "p99, ns a read",
          "max, ns a read"], rows, found)
    return 0


if __name__ == "__main__":
    sys.exit(main())
