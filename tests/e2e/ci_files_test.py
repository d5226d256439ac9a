#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The job files for CI services: the commands in them, as the services would run them."""

import os
import shlex
import subprocess
import unittest
from pathlib import Path

from programs import BIN, Case, obj, tetrahedron

try:
    import yaml
except ImportError:
    yaml = None

FILES = Path(__file__).resolve().parents[2] / "scripts" / "ci"
SHARDS = 4


def commands_of(job, shard):
    """The lines of a job's steps that call spm-bake, for a shard."""
    steps = [step.get("run", "") for step in job.get("steps", ())]
    steps += job.get("script", []) + job.get("after_script", [])
    replaced = {"${{ matrix.shard }}": str(shard), "$CI_NODE_INDEX": str(shard),
                "$CI_NODE_TOTAL": str(SHARDS)}
    for step in steps:
        for old, new in replaced.items():
            step = step.replace(old, new)
        if step.startswith("spm-bake "):
            yield step


@unittest.skipUnless(yaml, "python3-yaml is not installed")
class JobFiles(Case):
    def setUp(self):
        super().setUp()
        for place in range(SHARDS):
            self.write(f"{place}.obj", obj(tetrahedron(0.05 + place / 1000)))
        self.write("assets.toml", '[[asset]]\nmesh = "*.obj"\noutput = "{stem}.spm.exr"\n'
                                  'max-depth = "10mm"\nmargin = "5mm"\ntolerance = "1mm"\n')

    def call(self, command):
        self.assertNotIn("$", shlex.join(shlex.split(command)).replace("*", ""))
        return subprocess.run(["bash", "-c", command], cwd=self.folder, capture_output=True, text=True,
                              check=False, env={**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}"})

    def expect_bakes(self, bake, merge):
        for shard in range(1, SHARDS + 1):
            for command in commands_of(bake, shard):
                done = self.call(command)
                self.assertEqual(done.returncode, 0, command + done.stderr)
        command, = commands_of(merge, 1)
        done = self.call(command)
        self.assertEqual((done.returncode, done.stdout), (0, "4 of 4 assets done, of 4 shards\n"))
        os.unlink(self.path("result-2.json"))
        self.assertEqual(self.call(command).returncode, 11)

    def test_github_actions(self):
        jobs = yaml.safe_load((FILES / "github-actions.yml").read_text(encoding="utf-8"))["jobs"]
        self.assertEqual(jobs["bake"]["strategy"]["matrix"]["shard"], list(range(1, SHARDS + 1)))
        self.assertEqual(jobs["merge"]["needs"], "bake")
        self.expect_bakes(jobs["bake"], jobs["merge"])

    def test_gitlab(self):
        jobs = yaml.safe_load((FILES / "gitlab-ci.yml").read_text(encoding="utf-8"))
        self.assertEqual(jobs["bake"]["parallel"], SHARDS)
        self.expect_bakes(jobs["bake"], jobs["merge"])


if __name__ == "__main__":
    unittest.main()
