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

    def demo(self, **environment):
        done = subprocess.run([self.path("scripts", "demo")], capture_output=True, text=True, check=False,
                              stdin=subprocess.DEVNULL, env={**os.environ, **environment})
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def install(self):
        """Programs of this version, as packages install them."""
        self.write("CMakeLists.txt", "project(spm-haptics VERSION 1.2.3 LANGUAGES C CXX)\n")
        for name, said in (("spm-bake", BAKED), ("spm-servo", FELT)):
            os.unlink(self.path("build", "release", "bin", name))
            self.stand_in(f"installed/{name}", f"{SHELL}[[ $1 == --version ]] && echo {name} 1.2.3 && exit\n"
                                               f"echo '{json.dumps(said)}'\n")
        self.stand_in("scripts/setup", SHELL)
        self.stand_in("scripts/build", f"{SHELL}exit 9\n")

    def test_it_says_what_it_does_and_how_to_go_on_and_builds_no_page(self):
        self.stand_in("scripts/build_page", f"{SHELL}exit 9\n")
        done = self.demo()
        self.assertEqual([line.split(":")[0] for line in done.stderr.splitlines()],
                         [f"{step} of 4" for step in range(1, 5)])
        self.assertIn("Felt     5000 ticks", done.stdout)
        self.assertIn("build/release/bin/spm-servo run --asset build/demo/demo.spm.exr", done.stdout)
        self.assertIn("scripts/demo --view", done.stdout)

    def test_where_the_packages_are_installed_it_takes_their_programs_and_builds_nothing(self):
        self.install()
        done = self.demo(PATH=f"{self.path('installed')}:{os.environ['PATH']}")
        self.assertIn(f"{self.path('installed')}/spm-servo run", done.stdout)

    def test_packages_that_are_there_are_offered_before_it_builds(self):
        os.unlink(self.path("build", "release", "bin", "spm-servo"))
        self.stand_in("scripts/build", f"{SHELL}echo '{SHELL}' > build/release/bin/spm-servo\n"
                                       "echo building >&2; exit 9\n")
        self.stand_in("build/packages/spm-bake_1.2.3_amd64.deb", "")
        done = subprocess.run([self.path("scripts", "demo")], capture_output=True, text=True, check=False,
                              stdin=subprocess.DEVNULL)
        self.assertEqual(done.returncode, 9)
        self.assertRegex(done.stderr, r"^There are packages in build/packages\.(.|\n)*building\n$")

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
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, "^Touch it at drwx------ ")
        self.assertFalse(os.path.exists(done.stdout.split()[-1]))


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
