#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Meshes that cannot be baked: each gets its exit code and one line, and leaves nothing behind."""

import os
import struct
import unittest

from programs import NOBODY, TETRAHEDRON, Case, obj, off, ply, run, stl

VERTICES = "v 0 0 0\nv 0.05 0 0\nv 0 0.05 0\nv 0 0 0.05\n"
GARBAGE = bytes((i * 7919 + 13) % 256 for i in range(4096))
BEYOND = (TETRAHEDRON[0], TETRAHEDRON[1] + [(0, 1, 99)])

# What is wrong, the file's name, its bytes.
MESHES = [
    ("empty OBJ", "a.obj", ""),
    ("empty PLY", "a.ply", ""),
    ("empty STL", "a.stl", ""),
    ("empty OFF", "a.off", ""),
    ("comments only", "a.obj", "# nothing\n# here\n"),
    ("no triangles", "a.obj", VERTICES),
    ("a face of two corners", "a.obj", VERTICES + "f 1 2\n"),
    ("a face cut short", "a.obj", VERTICES + "f 1 2"),
    ("an index out of range", "a.obj", VERTICES + "f 1 2 9\n"),
    ("an index of zero", "a.obj", VERTICES + "f 0 1 2\n"),
    ("a negative index out of range", "a.obj", VERTICES + "f -1 -2 -9\n"),
    ("an index that is no number", "a.obj", VERTICES + "f 1 two 3\n"),
    ("a coordinate that is no number", "a.obj", "v 0 0 zero\n" + VERTICES + "f 1 2 3\n"),
    ("a vertex of two coordinates", "a.obj", "v 0 0\n" + VERTICES + "f 1 2 3\n"),
    ("a NaN", "a.obj", "v nan 0 0\n" + VERTICES + "f 1 2 3\nf 2 3 4\n"),
    ("an infinity", "a.obj", "v inf 0 0\n" + VERTICES + "f 1 2 3\nf 2 3 4\n"),
    ("a coordinate too large for a double", "a.obj", "v 1e999 0 0\n" + VERTICES + "f 1 2 3\n"),
    ("binary garbage as OBJ", "a.obj", GARBAGE),
    ("binary garbage as PLY", "a.ply", GARBAGE),
    ("binary garbage as STL", "a.stl", GARBAGE),
    ("binary garbage as OFF", "a.off", GARBAGE),
    ("a PLY cut short in its header", "a.ply", ply(TETRAHEDRON)[:40]),
    ("a text PLY cut short", "a.ply", ply(TETRAHEDRON)[:-12]),
    ("a binary PLY cut short", "a.ply", ply(TETRAHEDRON, binary=True)[:-5]),
    ("a PLY of an unknown format", "a.ply", ply(TETRAHEDRON).replace(b"ascii", b"morse")),
    ("a PLY with an index out of range", "a.ply", ply(BEYOND)),
    ("a binary PLY with an index out of range", "a.ply", ply(BEYOND, binary=True)),
    ("a PLY without faces", "a.ply", ply((TETRAHEDRON[0], []))),
    ("a PLY with a NaN", "a.ply",
     ply(([(float("nan"), 0.0, 0.0)] + TETRAHEDRON[0][1:], TETRAHEDRON[1]), binary=True)),
    ("a PLY that claims too many vertices", "a.ply",
     ply(TETRAHEDRON, binary=True).replace(b"vertex 4", b"vertex 4000000000")),
    ("an STL cut short", "a.stl", stl(TETRAHEDRON)[:-30]),
    ("an STL of no triangles", "a.stl", stl(([], []))),
    ("an STL that claims too many triangles", "a.stl",
     b"\0" * 80 + struct.pack("<I", 0xFFFFFFFF) + stl(TETRAHEDRON)[84:]),
    ("a text STL cut short", "a.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"),
    ("an OFF cut short", "a.off", off(TETRAHEDRON)[:-12]),
    ("an OFF without its counts", "a.off", "OFF\nmany few none\n"),
    ("an OFF with an index out of range", "a.off", off(BEYOND)),
    ("triangles without area only", "a.obj", VERTICES + "f 1 1 2\nf 2 2 3\n"),
    ("corners on one line", "a.obj", "v 0 0 0\nv 0.01 0 0\nv 0.02 0 0\nf 1 2 3\n"),
    ("a wrong extension", "a.txt", obj(TETRAHEDRON)),
    ("no extension", "mesh", obj(TETRAHEDRON)),
    ("one format under another's name", "a.ply", obj(TETRAHEDRON)),
]


class BadMesh(Case):
    def bake(self, mesh, code, *names, user=None):
        out = self.output_folder()
        os.chmod(out, 0o777)
        result = run("build", mesh, "-o", os.path.join(out, "a.spm.exr"), "--tolerance", "1mm",
                     user=user)
        self.expect_refusal(result, code, *names)
        self.assertEqual(os.listdir(out), [])

    def test_a_mesh_that_cannot_be_baked_is_refused_as_invalid_input(self):
        for what, name, content in MESHES:
            with self.subTest(what):
                self.bake(self.write(name, content), 3, name)

    def test_a_mesh_that_cannot_be_opened_is_a_file_error(self):
        with self.subTest("missing"):
            self.bake(self.path("missing.obj"), 2, "missing.obj")
        with self.subTest("a directory"):
            os.mkdir(self.path("folder.obj"))
            self.bake(self.path("folder.obj"), 2, "folder.obj")
        with self.subTest("in a folder that is none"):
            self.write("file", "")
            self.bake(self.path("file", "a.obj"), 2, "a.obj")
        with self.subTest("no permission"):
            path = self.write("secret.obj", obj(TETRAHEDRON))
            os.chmod(path, 0)
            self.bake(path, 2, "secret.obj", user=NOBODY if os.geteuid() == 0 else None)

    def test_the_message_names_the_line(self):
        self.bake(self.write("a.obj", VERTICES + "# a remark\nf 1 2 9\n"), 3, "a.obj", "line 6", "9")

    def test_a_name_that_is_not_text_is_no_obstacle_to_saying_so(self):
        self.bake(self.path("n\n\u00e9w.obj"), 2, "w.obj")


if __name__ == "__main__":
    unittest.main()
