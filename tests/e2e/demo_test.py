#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What scripts/demo says at its end, in a checkout where all that takes long is a stand-in; and where view
looks for its page in a build folder."""

import json
import os
import shutil
import subprocess
import unittest

from programs import SERVO, Case, run

SCRIPTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, os.pardir, "scripts")
SHELL, PYTHON = "#!/usr/bin/env bash\n", "#!/usr/bin/env python3\n"
BAKED = {"mesh": {"triangles": 12, "closed": True, "border_edges": 0}, "bytes": 1000,
         "spm": {"tiles": 6, "planes": 6}, "error_um": {"p99": 1, "max": 2, "samples": 9},
         "tolerance_um": 100, "tolerance_met": True, "seconds": {"total": 1}}
FELT = {"ticks": 5000, "contact_ticks": 4000, "rate_hz": 1000, "missed": 0, "force_n": {"max": 1},
        "busy_us": {"p50": 1, "p99": 2}, "page_faults": 0, "force_off": [],
        "realtime": {"policy": "none", "memory_locked": False}}
PAGE = "build/release/share/spm-haptics/view/index.html"


class Demo(Case):
    def setUp(self):
        super().setUp()
        for name in ("demo", "demo_summary.py"):
            os.makedirs(self.path("scripts"), exist_ok=True)
            shutil.copy(os.path.join(SCRIPTS, name), self.path("scripts", name))
        for name, text in (("scripts/build", SHELL), ("models/generate.py", PYTHON),
                           ("scripts/charts/plot_force.py", PYTHON), ("scripts/draw_touch", SHELL),
                           ("build/release/bin/spm-bake", f"{SHELL}echo '{json.dumps(BAKED)}'\n"),
                           ("build/release/bin/spm-servo", f"{SHELL}echo '{json.dumps(FELT)}'\n")):
            self.stand_in(name, text)

    def stand_in(self, name, text):
        os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
        os.chmod(self.write(name, text), 0o755)

    def demo(self, build_page):
        self.stand_in("scripts/build_page", SHELL + build_page)
        done = subprocess.run([self.path("scripts", "demo")], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout

    def test_it_builds_the_page_and_says_how_it_is_seen(self):
        said = self.demo(f"mkdir -p {os.path.dirname(PAGE)} && touch {PAGE}\n")
        self.assertIn("scripts/demo --view", said)
        self.assertIn("libspm_client.so", said)
        self.assertNotIn("not built", said)

    def test_with_view_the_programs_meet_also_where_the_user_has_no_folder_for_sockets(self):
        os.makedirs(self.path("build", "demo"))
        self.write(os.path.join("build", "demo", "demo.spm.exr"), "")
        self.stand_in("scripts/build_page", SHELL)
        self.stand_in("build/release/bin/spm-servo", SHELL + '[[ $1 == run ]] || ls -ld "$XDG_RUNTIME_DIR"\n')
        environment = {name: value for name, value in os.environ.items()
                       if name not in ("XDG_RUNTIME_DIR", "DISPLAY", "WAYLAND_DISPLAY")}
        if os.path.isdir(f"/run/user/{os.getuid()}"):
            self.skipTest("this user has a folder for sockets")
        done = subprocess.run([self.path("scripts", "demo"), "--view"], capture_output=True, text=True,
                              check=False, env=environment)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertRegex(done.stdout, "^Touch it at drwx------ ")
        self.assertFalse(os.path.exists(done.stdout.split()[-1]))

    def test_where_the_page_could_not_be_built_it_goes_on_and_says_by_which_command_it_is(self):
        said = self.demo("exit 2\n")
        self.assertIn("Felt     5000 ticks", said)
        self.assertRegex(said, r"page .* was not built(.|\n)*scripts/build_page release\n")


class Page(Case):
    """The page of `spm-servo view`, looked for beside a program in a build folder."""

    def setUp(self):
        super().setUp()
        os.makedirs(self.path("build", "debug", "bin"))
        self.program = shutil.copy(SERVO, self.path("build", "debug", "bin"))
        self.write(os.path.join("build", "debug", "CMakeCache.txt"), "")

    def test_where_it_is_not_built_view_says_by_which_command_it_is(self):
        result = run("view", program=self.program)
        self.expect_refusal(result, 5, "build/debug/share/spm-haptics/view", "scripts/build_page")

    def test_that_of_the_release_build_beside_is_taken(self):
        folder = self.output_folder(os.path.dirname(PAGE))
        for name in ("index.html", "view.js", "view.css", "icon.svg"):
            self.write(os.path.join(folder, name), "a page")
        process = subprocess.Popen([self.program, "view", "--json"], stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.communicate)
        self.addCleanup(process.terminate)
        self.assertTrue(json.loads(process.stdout.readline())["url"].startswith("http://127.0.0.1"))


if __name__ == "__main__":
    unittest.main()
