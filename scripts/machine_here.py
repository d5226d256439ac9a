# SPDX-License-Identifier: Apache-2.0
"""What a report says of the machine that made it."""

import os
import platform
import subprocess
from pathlib import Path


def machine_here() -> dict:
    """For reports that spm-bench does not write; the keys are those of its `made.machine`."""
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        models = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
    compiler = subprocess.run(("g++", "-dumpfullversion"), check=True, capture_output=True, text=True).stdout
    return {"processor": models[0] if models else "", "cores": os.cpu_count(),
            "memory_bytes": os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"),
            "system": platform.freedesktop_os_release()["PRETTY_NAME"],
            # Without what the one who built it added to the version.
            "kernel": f"{platform.system()} {platform.release().split('-')[0]}",
            "compiler": "g++ " + compiler.strip(), "build": "Release"}


def made_here(command: str) -> dict:
    """Which program made a report by which command, and on what; for reports that scripts write."""
    commit = subprocess.run(("git", "-C", Path(__file__).parent, "rev-parse", "--short=12", "HEAD"),
                            check=True, capture_output=True, text=True).stdout.strip()
    return {"commit": commit, "machine": machine_here(), "command": command}
