#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Batches through a real Slurm, and through Snakemake with it: the bytes of one run, and failures
that are told. scripts/test-cluster runs it."""

import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve()
sys.path.insert(0, str(HERE.parents[1]))
from programs import BAKE, BIN, obj, tetrahedron  # noqa: E402
from slurm_here import SlurmHere  # noqa: E402

CLUSTER = HERE.parents[3] / "scripts" / "cluster"
MESHES = 8


class Cluster(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.mkdtemp(prefix="spm-cluster-")
        cls.addClassCleanup(shutil.rmtree, folder, ignore_errors=True)
        cls.slurm = SlurmHere(folder)
        cls.addClassCleanup(cls.slurm.stop)
        cls.environment = {**cls.slurm.environment, "PATH": f"{BIN}:{os.environ['PATH']}"}

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="spm-cluster-batch-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        (self.folder / "meshes").mkdir()
        (self.folder / "baked").mkdir()
        for place in range(MESHES):
            (self.folder / f"meshes/{place}.obj").write_text(obj(tetrahedron(0.05 + place / 1000)))
        self.manifest = self.folder / "assets.toml"
        self.manifest.write_text(
            '[defaults]\nmax-depth = "10mm"\nmargin = "5mm"\ntolerance = "1mm"\n'
            '[[asset]]\nmesh = "meshes/*.obj"\noutput = "baked/{stem}.spm.exr"\n')

    def run_it(self, *command, folder=None):
        return subprocess.run([*map(str, command)], cwd=folder or self.folder, env=self.environment,
                              capture_output=True, text=True, check=False, timeout=600)

    def baked(self):
        return {path.name: hashlib.sha256(path.read_bytes()).hexdigest()
                for path in sorted((self.folder / "baked").iterdir())}

    def one_run(self):
        """The bytes that one run gives, which then are removed."""
        done = self.run_it(BAKE, "batch", self.manifest, "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        whole = self.baked()
        for name in whole:
            (self.folder / "baked" / name).unlink()
        return whole

    def test_a_job_array_bakes_the_bytes_of_one_run(self):
        whole = self.one_run()
        done = self.run_it(CLUSTER / "bake_on_slurm", 4, "assets.toml", "--cpus-per-task=1")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn(f"{MESHES} of {MESHES} assets done, of 4 shards", done.stdout)
        self.assertEqual(self.baked(), whole)

    def test_a_mesh_that_cannot_be_baked_is_named_and_the_others_are_there(self):
        (self.folder / "meshes/3.obj").write_text("v 0 0 0\n")
        done = self.run_it(CLUSTER / "bake_on_slurm", 3, "assets.toml")
        self.assertEqual(done.returncode, 11, done.stdout + done.stderr)
        self.assertIn("error: 3: ", done.stderr)
        self.assertEqual(len(self.baked()), MESHES - 1)

    def test_a_job_that_never_ran_is_no_success(self):
        done = self.run_it(CLUSTER / "bake_on_slurm", 2, "assets.toml", "--time=1", "--partition=none")
        self.assertEqual(done.returncode, 11, done.stdout)
        self.assertIn("shard 1 left no result", done.stderr)

    def test_snakemake_bakes_the_bytes_of_one_run_here_and_by_slurm(self):
        whole = self.one_run()
        snakefile = CLUSTER / "Snakefile"
        config = ("--config", "manifest=assets.toml", "shards=3", f"options=--cache {self.folder}/cache")
        done = self.run_it("snakemake", "-s", snakefile, "--cores", 2, *config)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.baked(), whole)
        for name in whole:
            (self.folder / "baked" / name).unlink()
        shutil.rmtree(self.folder / "spm-results")
        done = self.run_it("snakemake", "-s", snakefile, "--profile", CLUSTER / "slurm-profile",
                           "--jobs", 3, "--latency-wait", 5, *config)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.baked(), whole)
        merged = json.loads((self.folder / "spm-results/merged.json").read_text())
        self.assertEqual((merged["done"], merged["passed"]), (MESHES, True))
        # Nothing changed: nothing is to be done. A mesh changed: only its shard is.
        self.assertIn("Nothing to be done",
                      self.run_it("snakemake", "-s", snakefile, "--cores", 1, *config).stderr)
        (self.folder / "meshes/5.obj").write_text(obj(tetrahedron(0.06)))
        done = self.run_it("snakemake", "-s", snakefile, "--cores", 1, *config)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([name for name in whole if self.baked()[name] != whole[name]], ["5.spm.exr"])


if __name__ == "__main__":
    unittest.main()
