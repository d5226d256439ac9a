# SPDX-License-Identifier: Apache-2.0
"""A folder that looks like a checkout with its build, for what is looked for there."""

import os
import shutil
import subprocess
import sys
from pathlib import Path


def find_in_checkout(folder: Path, module: Path, place: str, library: str, name: str, code: str) -> str:
    """Copies a folder of Python modules to a place in a made checkout, links a library into its build
    folder by a name, and runs code there that prints the path of the library that was found. Gives it
    within the checkout, or what went wrong."""
    folder = folder.resolve()
    shutil.copytree(module, folder / place)
    (folder / "CMakePresets.json").touch()
    built = folder / "build" / "release" / "lib"
    built.mkdir(parents=True)
    (built / name).symlink_to(Path(library).resolve())
    kept = {key: value for key, value in os.environ.items() if not key.endswith("_LIBRARY")}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False,
                          env={**kept, "PYTHONPATH": str(folder / place)})
    return done.stdout.strip().removeprefix(f"{folder}/") or done.stderr
