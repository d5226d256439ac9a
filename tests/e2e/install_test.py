#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What `cmake --install` puts down is all that a user's project needs, in C, C++, Python and C#."""

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import installed_layouts
from programs import BIN, obj, tetrahedron

BUILD = os.path.dirname(BIN)
CONSUMERS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "consumers")
PATIENCE = 120.0  # s, beyond any machine's worst moment
INSIDE = ("0.001", "0.01", "0.01")  # a point 1 mm inside


def called(*command, **options):
    """What a command prints, which must succeed."""
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False,
                          timeout=300, **options)
    assert done.returncode == 0, f"{command}: {done.stdout}{done.stderr}"
    return done.stdout


def install(prefix, *options):
    called("cmake", "--install", BUILD, "--prefix", prefix, *options)


def files_of(folder):
    return sorted(os.path.relpath(os.path.join(where, name), folder)
                  for where, _, names in os.walk(folder) for name in names)


class Installed(unittest.TestCase):
    """The whole project in a folder, and a user's project beside it."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="spm-e2e-install-")
        os.chmod(cls.folder, 0o700)
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.prefix = os.path.join(cls.folder, "there")
        install(cls.prefix)
        cls.library = cls.found("libspm_query.so.1")
        cls.libraries = os.path.dirname(cls.library)
        cls.project = os.path.join(cls.folder, "project")
        shutil.copytree(CONSUMERS, cls.project)
        with open(os.path.join(cls.project, "corner.obj"), "w", encoding="utf-8") as file:
            file.write(obj(tetrahedron(0.05)))
        cls.asset = os.path.join(cls.project, "corner.spm.exr")
        # Nothing of the system's or of the build's may be found in its stead.
        cls.environment = {
            "PATH": "/usr/bin:/bin", "HOME": cls.folder, "LC_ALL": "C.UTF-8",
            "LD_LIBRARY_PATH": cls.libraries, "XDG_RUNTIME_DIR": cls.folder,
            "PKG_CONFIG_PATH": os.path.join(cls.libraries, "pkgconfig"),
            "PYTHONPATH": os.path.join(cls.prefix, "lib/python3/dist-packages"),
            "PYTHONDONTWRITEBYTECODE": "1"}
        cls.built = called("cmake", "-S", cls.project, "-B", cls.path("out"), "-G", "Ninja",
                           f"-DCMAKE_PREFIX_PATH={cls.prefix}", env=cls.environment)
        cls.built += called("cmake", "--build", cls.path("out"), env=cls.environment)

    @classmethod
    def path(cls, *names):
        return os.path.join(cls.project, *names)

    @classmethod
    def found(cls, name):
        """The one file of a name below the prefix."""
        paths = [path for path in files_of(cls.prefix) if os.path.basename(path) == name]
        assert len(paths) == 1, (name, paths)
        return os.path.join(cls.prefix, paths[0])

    def run_it(self, *command):
        return called(*command, env=self.environment, cwd=self.project)

    def test_cmake_builds_a_project_and_bakes_its_assets_once(self):
        self.assertRegex(self.built, r"corner: .*corner\.spm\.exr, \d+ bytes")
        before = os.stat(self.asset).st_mtime_ns
        again = called("cmake", "--build", self.path("out"), "--verbose", env=self.environment)
        self.assertIn("batch", again)
        self.assertEqual(os.stat(self.asset).st_mtime_ns, before)
        self.assertEqual(self.run_it(self.path("out/touch_c"), self.asset, *INSIDE),
                         "-0.001000 m, 1.000 N\n")

    def test_a_component_that_is_not_there_is_named(self):
        prefix = os.path.join(self.folder, "no-bake")
        for component in ("query", "client", "dev"):
            install(prefix, "--component", component)
        done = subprocess.run(
            ["cmake", "-S", self.project, "-B", self.path("none"), "-G", "Ninja",
             f"-DCMAKE_PREFIX_PATH={prefix}", "-DCMAKE_FIND_USE_CMAKE_SYSTEM_PATH=OFF"],
            env=self.environment, capture_output=True, text=True, check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("component assets is not there: spm-bake was not found", done.stderr)

    def test_pkg_config_tells_a_compiler_all_that_it_needs(self):
        flags = self.run_it("pkg-config", "--cflags", "--libs", "spm-query").split()
        self.run_it("cc", "-Wall", "-Werror", "-o", "by_pkg_config", "touch.c", *flags)
        self.assertEqual(self.run_it(self.path("by_pkg_config"), self.asset, *INSIDE),
                         "-0.001000 m, 1.000 N\n")
        self.assertEqual(self.run_it("pkg-config", "--modversion", "spm-client"),
                         self.run_it("pkg-config", "--modversion", "spm-query"))

    def test_python_asks_many_points_in_one_call(self):
        try:
            import numpy  # noqa: F401
        except ImportError:
            self.skipTest("python3-numpy is not installed")
        shown = self.run_it(sys.executable, "touch.py", self.asset, "100000")
        counts = re.fullmatch(r"(\d+) points, (\d+) inside, (\d+) exact\n", shown)
        self.assertIsNotNone(counts, shown)
        # The corner of a cube is a sixth of it.
        self.assertEqual(int(counts[1]), 100000)
        self.assertAlmostEqual(int(counts[2]) / 100000, 1 / 6, delta=0.01)

    def test_programs_beside_the_daemon_read_the_hand(self):
        socket = os.path.join(self.folder, "a.sock")
        daemon = subprocess.Popen(
            [os.path.join(self.prefix, "bin/spm-servo"), "run", "--asset", self.asset, "--device", "sim",
             "--realtime", "off", "--black-box", "off", "--socket", socket, "--quiet"],
            env=self.environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.addCleanup(daemon.communicate)
        self.addCleanup(daemon.kill)
        deadline = time.monotonic() + PATIENCE
        while not os.path.exists(socket) and time.monotonic() < deadline and daemon.poll() is None:
            time.sleep(0.02)
        self.assertRegex(self.run_it(self.path("out/watch_cpp"), socket), r"^\d+\.\d{3} N\n$")
        if shutil.which("mcs") and shutil.which("mono"):
            sources = os.path.join(self.prefix, "share/spm-haptics/csharp")
            self.run_it("mcs", "-out:Watch.exe", "Watch.cs",
                        *[os.path.join(sources, name) for name in os.listdir(sources)
                          if name.endswith(".cs")])
            self.assertRegex(self.run_it("mono", "Watch.exe", socket), r"^\d+\.\d{3} N\n$")
        daemon.send_signal(signal.SIGTERM)
        _, errors = daemon.communicate(timeout=PATIENCE)
        self.assertEqual((daemon.returncode, errors), (0, b""))

    def test_the_libraries_export_what_their_lists_say_under_soname_1(self):
        for name in ("query", "client"):
            with self.subTest(name):
                library = self.found(f"libspm_{name}.so.1")
                self.assertEqual(installed_layouts.exported_symbols(library),
                                 installed_layouts.kept_symbols(name))
                dynamic = called("readelf", "-d", library)
                self.assertIn(f"soname: [libspm_{name}.so.1]", dynamic)
                self.assertNotIn("RUNPATH", dynamic)

    def test_no_member_of_a_struct_has_moved(self):
        """What was added at an end shows here too: then a program that was built before must be
        thought of, and the new layouts kept."""
        self.assertEqual(installed_layouts.layouts(os.path.join(self.prefix, "include")),
                         installed_layouts.KEPT.read_text(encoding="utf-8"))

    def test_programs_need_nothing_of_the_build_folder(self):
        for program in ("spm-bake", "spm-servo"):
            path = os.path.join(self.prefix, "bin", program)
            self.assertNotIn("RUNPATH", called("readelf", "-d", path))
            self.assertTrue(self.run_it(path, "--version").startswith(program))
        with open(self.found("spm-servo.service"), encoding="utf-8") as file:
            self.assertIn(f"ExecStart={self.prefix}/bin/spm-servo run ", file.read())
        page = self.found("spm-servo.1.gz")
        self.assertIn("NAME", called("gzip", "-dc", page))

    def test_each_component_can_be_had_alone(self):
        seen = {}
        for component, wanted in {"bake": "bin/spm-bake", "servo": "bin/spm-servo",
                                  "query": "libspm_query.so.1", "client": "libspm_client.so.1",
                                  "dev": "include/spm_query.h", "python": "spm_query.py"}.items():
            prefix = os.path.join(self.folder, component)
            install(prefix, "--component", component)
            files = files_of(prefix)
            self.assertTrue(any(path.endswith(wanted) for path in files), (component, files))
            for path in files:
                self.assertNotIn(path, seen, f"{seen.get(path)} and {component} have it")
                seen[path] = component
        self.assertEqual(sorted(seen), files_of(self.prefix))


if __name__ == "__main__":
    unittest.main()
