#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""spm-bake as a user runs it: what it prints, writes and promises."""

import csv
import math
import os
import struct
import unittest

from programs import BUILD_KEYS, NUMBER, TETRAHEDRON, THIN_BAND, Case, digest, merged, obj, run, sphere

RADIUS = 0.02
SPHERE = obj(sphere(RADIUS))
TOLERANCE = 200e-6

VERIFY_KEYS = {
    "distance_error_um": {"rms": NUMBER, "p50": NUMBER, "p99": NUMBER, "p999": NUMBER,
                          "max": NUMBER},
    "direction_error_deg": {"p50": NUMBER, "p99": NUMBER, "max": NUMBER},
    "misclassified": {"inside_as_outside": NUMBER, "outside_as_inside": NUMBER},
    "unanswered": NUMBER, "samples": int, "band_m": NUMBER, "tolerance_um": NUMBER, "passed": bool,
    "counts": {"unanswered": int, "wrong_side": int, "beyond_tolerance": int}, "worst": list,
    "seed": int, "verdict": str,
}


def read_ply(path):
    """Vertices and faces of a PLY as export writes it, binary or text."""
    with open(path, "rb") as file:
        data = file.read()
    head, body = data.split(b"end_header\n", 1)
    lines = head.decode().splitlines()
    counts = {line.split()[1]: int(line.split()[2]) for line in lines if line.startswith("element")}
    vertices, faces = counts["vertex"], counts["face"]
    if "format ascii 1.0" in lines:
        rows = body.decode().splitlines()
        points = [tuple(map(float, row.split())) for row in rows[:vertices]]
        triangles = [tuple(map(int, row.split()))[1:] for row in rows[vertices:]]
    else:
        points = [struct.unpack_from("<3f", body, 12 * i) for i in range(vertices)]
        triangles = [struct.unpack_from("<B3i", body, 12 * vertices + 13 * i)[1:]
                     for i in range(faces)]
        assert len(body) == 12 * vertices + 13 * faces
    assert len(triangles) == faces
    return points, triangles


def read_ply_points(path):
    """Places of a PLY of points as verify writes it."""
    with open(path, encoding="ascii") as file:
        _, body = file.read().split("end_header\n", 1)
    return [tuple(map(float, row.split()[:3])) for row in body.splitlines()]


class Bake(Case):
    OPTIONS = {"sparse": ("--tolerance", "200um", "--max-depth", "1mm"),
               "full": ("--form", "full", "--planes", "20", "--resolution", "17", "--max-depth",
                        "1mm")}
    kept = {}  # of each form, what build said and the file's bytes: a bake takes seconds

    def setUp(self):
        super().setUp()
        self.mesh = self.write("sphere.obj", SPHERE)
        self.asset = self.path("sphere.spm.exr")

    def build(self, *options):
        return self.run_json("build", self.mesh, "-o", self.asset, *options)

    def baked(self, form):
        """What build said; its asset lies at `self.asset`, the mesh at `self.mesh`."""
        if form not in self.kept:
            report = self.build(*self.OPTIONS[form], "--threads", "1")
            with open(self.asset, "rb") as file:
                self.kept[form] = (report, file.read())
        report, content = self.kept[form]
        self.write("sphere.spm.exr", content)
        return report

    def expect_keys(self, found, wanted, place=""):
        for key, kind in wanted.items():
            self.assertIn(key, found, place)
            if isinstance(kind, dict):
                self.expect_keys(found[key], kind, place + key + ".")
            else:
                self.assertIsInstance(found[key], kind, place + key)
                if kind != bool and kind != list:
                    self.assertNotIsInstance(found[key], bool, place + key)

    def test_build_reports_what_the_contract_names(self):
        report = self.baked("sparse")
        self.expect_keys(report, BUILD_KEYS)
        self.assertEqual(os.path.basename(report["mesh"]["path"]), "sphere.obj")
        self.assertEqual(report["mesh"]["triangles"], SPHERE.count("\nf "))
        self.assertEqual(report["mesh"]["vertices"], SPHERE.count("v "))
        self.assertTrue(report["mesh"]["closed"])
        self.assertEqual(report["mesh"]["components"], 1)
        self.assertEqual(report["mesh"]["border_edges"], 0)
        self.assertEqual(report["mesh"]["sha256"], digest(self.mesh))
        for axis in range(3):
            self.assertAlmostEqual(report["mesh"]["bbox_m"]["min"][axis], -RADIUS, places=9)
            self.assertAlmostEqual(report["mesh"]["bbox_m"]["max"][axis], RADIUS, places=9)
        self.assertEqual(report["spm"]["form"], "sparse")
        self.assertEqual(report["bytes"], os.path.getsize(self.asset))
        self.assertEqual(report["content_sha256"], digest(self.asset))
        self.assertAlmostEqual(report["tolerance_um"], 200)
        self.assertTrue(report["tolerance_met"])
        self.assertLessEqual(report["error_um"]["max"], 200)
        for share in report["fallback"].values():
            self.assertTrue(0 <= share <= 1)

    def test_a_full_asset_has_no_tolerance(self):
        report = self.baked("full")
        self.expect_keys(report, {**BUILD_KEYS, "tolerance_um": type(None)})
        self.assertIsNone(report["tolerance_um"])
        self.assertFalse(report["tolerance_met"])
        self.assertEqual(report["spm"]["form"], "full")
        self.assertEqual(report["spm"]["planes"], 20)
        self.assertIn(report["spm"]["kind"], ("face", "vertex"))

    def test_a_default_tolerance_is_said_unless_quiet_is_asked(self):
        arguments = ["build", self.mesh, "-o", self.asset, "--allow-inexact", *THIN_BAND]
        result = run(*arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("warning: no --tolerance: taking 1/1000 of the diagonal, 69.", result.stderr)
        quiet = run(*arguments, "--quiet")
        self.assertEqual((quiet.returncode, quiet.stdout, quiet.stderr), (0, "", ""))

    def test_the_bytes_do_not_depend_on_threads_or_paths_and_a_pipe_sees_no_progress(self):
        for form, options in self.OPTIONS.items():
            with self.subTest(form):
                content = self.baked(form)["content_sha256"]
                other = self.path("elsewhere.spm.exr")
                result = run("build", self.mesh, "-o", other, "--threads", "2", *options)
                self.assertEqual((result.returncode, result.stderr), (0, ""))
                self.assertIn(other, result.stdout)
                self.assertNotIn("\r", result.stdout)
                self.assertEqual(digest(other), content)

    def test_a_coarser_direction_tolerance_takes_no_more_bytes(self):
        sizes = []
        for angle in ("1deg", "4deg", "12deg"):
            report = self.run_json("build", self.mesh, "-o", self.asset, "--direction-tolerance",
                                   angle, *self.OPTIONS["sparse"])
            self.assertLessEqual(report["direction_error_deg"]["p50"],
                                 report["direction_error_deg"]["tolerance"])
            sizes.append(report["bytes"])
        self.assertGreater(sizes[0], sizes[1])
        self.assertGreaterEqual(sizes[1], sizes[2])
        for angle, word in (("0deg", "above 0"), ("90deg", "at most 45"), ("4", "unit")):
            with self.subTest(angle):
                self.expect_refusal(run("build", self.mesh, "-o", self.asset,
                                        "--direction-tolerance", angle), 1,
                                    "--direction-tolerance", word)
        self.expect_refusal(run("build", self.mesh, "-o", self.asset, "--form", "full",
                                "--direction-tolerance", "4deg"), 1, "--form sparse")

    def box_mesh(self):
        box = [(x, y, z) for x in (0, 48) for y in (0, 60) for z in (0, 64)]
        sides = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
        halves = [(a - 1, i - 1, k - 1) for a, b, c, d in sides for i, k in ((b, c), (c, d))]
        return self.write("box.obj", obj((box, halves)))

    def test_a_file_takes_no_more_bytes_than_it_may(self):
        mesh, sizes = self.box_mesh(), []
        for most in (100000, None, 10500):
            options = () if most is None else ("--max-bytes", str(most))
            report = self.run_json("build", mesh, "-o", self.asset, "--unit", "mm", *options)
            sizes.append(report["bytes"])
            self.assertTrue(report["tolerance_met"])
            self.assertLessEqual(os.path.getsize(self.asset), most or 40000)
        self.assertGreater(sizes[0], sizes[1])
        self.assertGreater(sizes[1], sizes[2])
        os.remove(self.asset)
        self.expect_refusal(run("build", mesh, "-o", self.asset, "--unit", "mm", "--max-bytes",
                                "2000"), 10, "--max-bytes", "--tolerance")
        self.assertFalse(os.path.exists(self.asset))
        self.expect_refusal(run("build", mesh, "-o", self.asset, "--form", "full", "--max-bytes",
                                "5000"), 1, "--form sparse")

    def test_the_size_is_told_and_a_doubtful_unit_asked_about(self):
        mesh = self.box_mesh()
        doubtful = run("build", mesh, "-o", self.asset)
        self.expect_refusal(doubtful, 3, "100 m from corner to corner; is it in mm?", "--unit")
        self.assertFalse(os.path.exists(self.asset))
        self.expect_refusal(run("build", self.write("tiny.obj", obj(sphere(1e-6))), "-o", self.asset), 3,
                            "--unit")
        large = run("build", mesh, "-o", self.asset, "--unit", "m")
        self.assertEqual(large.returncode, 0, large.stderr)
        self.assertNotIn("is it in mm?", large.stderr)
        sure = run("build", mesh, "-o", self.asset, "--unit", "mm")
        self.assertIn("size     48 x 60 x 64 mm", sure.stdout)
        self.assertNotIn("is it in mm?", sure.stderr)
        # Few triangles bake at once into a small file.
        self.assertLess(os.path.getsize(self.asset), 40000)

    def test_a_folder_that_is_missing_is_made_once_there_is_something_to_write(self):
        output = self.path("new/folder/a.spm.exr")
        self.expect_refusal(run("build", self.box_mesh(), "-o", output), 3, "--unit")
        self.assertFalse(os.path.exists(self.path("new")))
        self.assertEqual(run("build", self.box_mesh(), "-o", output, "--unit", "mm").returncode, 0)
        self.assertEqual(os.listdir(self.path("new/folder")), ["a.spm.exr"])

    def test_a_mesh_with_what_nobody_wants_is_refused_with_places(self):
        vertices, triangles = TETRAHEDRON
        meshes = {"open": (vertices, triangles[1:]), "repaired": (vertices, triangles + triangles[:1]),
                  "sheets": (vertices[:3], [(0, 1, 2)]),
                  "nonmanifold": (vertices + [(-0.02, 0.03, -0.05)], triangles + [(*triangles[0][:2], 4)]),
                  "selfintersecting": merged(TETRAHEDRON, ([(x + 0.003, y + 0.002, z + 0.001)
                                                            for x, y, z in vertices], triangles))}
        output = self.path("new.spm.exr")
        words = ("open", "nonmanifold", "selfintersecting", "sheets", "lids", "repaired")
        for word, mesh in meshes.items():
            path = self.write(word + ".obj", obj(mesh))
            with self.subTest(word):
                self.expect_refusal(run("build", path, "-o", output, "--fail-on", word, *THIN_BAND), 3,
                                    "--fail-on " + word, "mm", word + ".obj")
                self.assertFalse(os.path.exists(output))
                report = self.run_json("build", path, "-o", output, *THIN_BAND)
                found = {each["kind"]: each for each in report["solid"]["found"]}
                self.assertIn(word, found)
                self.assertEqual(len(found[word]["place_m"]), 3)
                self.assertEqual(self.run_json("info", output)["solid"], report["solid"])
                self.assertIn(found[word]["what"], run("info", output).stdout)
                os.remove(output)
        self.assertEqual(run("build", self.write("whole.obj", obj(TETRAHEDRON)), "-o", output, "--fail-on",
                             ",".join(words), *THIN_BAND).returncode, 0)
        self.expect_refusal(run("build", path, "-o", output, "--fail-on", "cracks"), 1, "cracks",
                            "selfintersecting")

    def test_a_tolerance_that_is_not_met_writes_nothing(self):
        # No error so small can be proven in floats. Few triangles, since each is split to the last.
        self.mesh = self.write("tetrahedron.obj", obj(TETRAHEDRON))
        arguments = ["build", self.mesh, "-o", self.asset, "--tolerance", "0.1um", *THIN_BAND]
        refused = run(*arguments)
        self.expect_refusal(refused, 10, "sphere.spm.exr", "tolerance", "--allow-inexact")
        self.assertFalse(os.path.exists(self.asset))
        report = self.run_json(*arguments, "--allow-inexact")
        self.assertFalse(report["tolerance_met"])
        self.assertTrue(os.path.exists(self.asset))

    def test_unit_and_fit_diagonal_scale_the_mesh_and_verify_applies_them(self):
        in_millimetres = self.write("mm.obj", obj(sphere(1000 * RADIUS)))
        report = self.run_json("build", in_millimetres, "-o", self.asset, "--unit", "mm",
                               "--tolerance", "1mm", "--fit-diagonal", "60mm", *THIN_BAND)
        side = 0.06 / math.sqrt(3)
        self.assertAlmostEqual(report["mesh"]["bbox_m"]["max"][0], side / 2, places=9)
        verified = self.run_json("verify", self.asset, in_millimetres, "--samples", "500")
        self.assertEqual(verified["unanswered"], 0)
        self.assertLess(verified["distance_error_um"]["max"], 1000)

    def test_verify_reports_what_the_contract_names(self):
        self.baked("sparse")
        report = self.run_json("verify", self.asset, self.mesh, "--samples", "3000")
        self.expect_keys(report, VERIFY_KEYS)
        self.assertEqual(report["samples"], 3000)
        self.assertAlmostEqual(report["band_m"], 0.001)
        self.assertLessEqual(report["distance_error_um"]["max"], 200)
        self.assertEqual(report["unanswered"], 0)
        self.assertEqual(report["misclassified"], {"inside_as_outside": 0, "outside_as_inside": 0})
        again = self.run_json("verify", self.asset, self.mesh, "--samples", "3000", "--threads", "1")
        self.assertEqual(again, report)
        shallow = self.run_json("verify", self.asset, self.mesh, "--samples", "100", "--band",
                                "0.5mm", "--seed", "7")
        self.assertAlmostEqual(shallow["band_m"], 0.0005)

    def test_verify_is_a_judge_and_says_what_it_found(self):
        self.baked("sparse")
        points = self.path("worst.ply")
        report = self.run_json("verify", self.asset, self.mesh, "--samples", "3000", "--worst", "7",
                               "--worst-ply", points)
        self.assertIs(report["passed"], True)
        self.assertAlmostEqual(report["tolerance_um"], 200)
        self.assertEqual(report["counts"],
                         {"unanswered": 0, "wrong_side": 0, "beyond_tolerance": 0, "pruned": 0,
                          "doubtful_gaps": 0})
        self.assertEqual(len(report["worst"]), 7)
        errors = [place["error_um"] for place in report["worst"]]
        self.assertEqual(errors, sorted(errors, reverse=True))
        self.assertEqual(errors[0], max(report["distance_error_um"]["max"],
                                        report["adversarial"]["distance_error_um"]["max"]))
        for place in report["worst"]:
            self.assertEqual(place["kind"], "within")
            self.assertAlmostEqual(math.hypot(*place["point"]) - RADIUS, place["exact_distance_m"],
                                   delta=200e-6)
        self.assertEqual(read_ply_points(points), [tuple(place["point"]) for place in report["worst"]])
        text = run("verify", self.asset, self.mesh, "--samples", "3000", "--seed", "5")
        self.assertEqual((text.returncode, text.stderr), (0, ""))
        self.assertEqual(text.stdout.splitlines()[-1],
                         "verdict        kept: 0 of 3,000 places and 0 of 1,500 hard ones beyond 200 "
                         "um, none unanswered, none on the wrong side (seed 5)")
        self.assertEqual(text.stdout.count("\nworst "), 20)

    def test_verify_of_an_asset_without_a_promise_says_so(self):
        self.baked("full")
        report = self.run_json("verify", self.asset, self.mesh, "--samples", "1000")
        self.assertIs(report["passed"], True)
        self.assertIsNone(report["tolerance_um"])
        self.assertTrue(report["verdict"].startswith("no promise"), report["verdict"])

    def test_verify_draws_the_surface_and_where_it_errs(self):
        self.baked("sparse")
        pictures = self.path("errors")
        report = self.run_json("verify", self.asset, self.mesh, "--samples", "300", "--png", pictures)
        names = ["direction.png", "error-section.png", "error-worst.png", "error.png",
                 "structure.png", "surface.png", "taken.png"]
        self.assertEqual(sorted(os.listdir(pictures)), names)
        self.assertEqual(sorted(map(os.path.basename, report["pictures"])), names)
        for name in names:
            with open(os.path.join(pictures, name), "rb") as file:
                self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")

    def test_info_tells_what_is_in_a_file_and_draws_it(self):
        for form in self.OPTIONS:
            with self.subTest(form):
                built = self.baked(form)
                pictures = self.path("pictures-" + built["spm"]["form"])
                report = self.run_json("info", self.asset, "--png", pictures)
                self.assertEqual(report["content_sha256"], built["content_sha256"])
                self.assertEqual(report["bytes"], built["bytes"])
                for key in ("form", "kind", "planes", "tiles", "layers_max"):
                    self.assertEqual(report["spm"][key], built["spm"][key])
                self.assertEqual(report["mesh"]["sha256"], built["mesh"]["sha256"])
                self.assertEqual(sum(report["bytes_by_kind"].values()), report["bytes"])
                self.assertEqual(sorted(map(os.path.basename, report["pictures"])),
                                 sorted(os.listdir(pictures)))
                self.assertIn("overview.png", os.listdir(pictures))
                for name in os.listdir(pictures):
                    with open(os.path.join(pictures, name), "rb") as file:
                        self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")
                before = {name: digest(os.path.join(pictures, name))
                          for name in os.listdir(pictures)}
                self.run_json("info", self.asset, "--png", pictures)
                self.assertEqual(before, {name: digest(os.path.join(pictures, name))
                                          for name in os.listdir(pictures)})

    def test_query_answers_in_the_order_asked(self):
        self.baked("sparse")
        points = [(RADIUS + 0.0001, 0, 0), (0, 0, 0), (0, RADIUS - 0.0005, 0), (1, 1, 1),
                  (0, 0, -RADIUS - 0.0001), (0, RADIUS - 0.0005, 0)]
        path = self.write("points.txt", "# six points\n" + "\n".join(
            f"{x!r} {y!r} {z!r}" for x, y, z in points) + "\n")
        counts = self.run_json("query", self.asset, "--points", path, "-o", self.path("out.csv"))
        self.assertEqual(counts["points"], len(points))
        with open(self.path("out.csv"), newline="", encoding="ascii") as file:
            self.assertEqual(file.readline().strip(),
                             "x,y,z,distance,nx,ny,nz,plane,layer,source,status")
            file.seek(0)
            rows = list(csv.DictReader(file))
        self.assertEqual([(float(r["x"]), float(r["y"]), float(r["z"])) for r in rows], points)
        for point, row in zip(points, rows):
            exact = math.hypot(*point) - RADIUS
            if row["status"] == "exact":
                self.assertAlmostEqual(float(row["distance"]), exact, delta=TOLERANCE + 200e-6)
                normal = [float(row[key]) for key in ("nx", "ny", "nz")]
                self.assertAlmostEqual(math.hypot(*normal), 1, places=9)
                self.assertIn(row["source"], ("map", "two-maps", "triangles"))
                self.assertEqual(int(row["plane"]) == -1, row["source"] == "triangles")
        self.assertEqual([row["status"] for row in rows],
                         ["exact", "deep", "exact", "far", "exact", "exact"])
        self.assertEqual(float(rows[1]["distance"]), -0.001)
        self.assertEqual(rows[3]["distance"], "nan")
        self.assertEqual(rows[3]["source"], "none")
        self.assertEqual(rows[2], rows[5])

    def test_export_is_the_surface_within_the_tolerance(self):
        for form, slack in (("sparse", TOLERANCE), ("full", 1e-3)):
            for options in ([], ["--ascii"]):
                with self.subTest(form + " ".join(options)):
                    self.baked(form)
                    surface = self.path("surface.ply")
                    counts = self.run_json("export", self.asset, "-o", surface, *options)
                    vertices, triangles = read_ply(surface)
                    self.assertEqual(len(vertices), counts["vertices"])
                    self.assertEqual(len(triangles), counts["triangles"])
                    self.assertGreater(len(triangles), 100)
                    facets = 150e-6  # what the mesh itself lies inside its sphere
                    for vertex in vertices:
                        self.assertAlmostEqual(math.hypot(*vertex), RADIUS, delta=slack + facets)
                    outward = 0
                    for triangle in triangles:
                        a, b, c = (vertices[i] for i in triangle)
                        u = [q - p for p, q in zip(a, b)]
                        v = [q - p for p, q in zip(a, c)]
                        normal = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                                  u[0] * v[1] - u[1] * v[0])
                        outward += sum(p * q for p, q in zip(normal, a)) > 0
                    self.assertGreater(outward, 0.99 * len(triangles))


if __name__ == "__main__":
    unittest.main()
