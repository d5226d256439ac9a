# SPDX-License-Identifier: Apache-2.0
"""The smallest asset that a daemon can serve."""

import subprocess
from pathlib import Path

TETRAHEDRON = ("v 0 0 0\nv 0.05 0 0\nv 0 0.05 0\nv 0 0 0.05\n"
               "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")


def bake_tetrahedron(bake: str, folder: Path) -> Path:
    """Bakes it into a folder; the path of the asset."""
    mesh, asset = folder / "mesh.obj", folder / "asset.spm.exr"
    mesh.write_text(TETRAHEDRON, encoding="utf-8")
    subprocess.run([bake, "build", mesh, "-o", asset, "--max-depth", "0.1mm", "--margin", "0.05mm",
                    "--quiet"], check=True, timeout=120)
    return asset
