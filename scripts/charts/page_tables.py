# SPDX-License-Identifier: Apache-2.0
"""Tables that stand on the project's pages, each a function from the JSON files under
tests/bench/charts, by their names, to lines of Markdown."""

import itertools
from typing import Iterable

import stiffness_borders
from markdown_table import number, table
from paper_tables import paper_tables
from scene_tables import scene_lines, sixdof_lines
from stability_rows import device_of
from stability_tables import failing_lines, stability_tables, target_lines, theory_lines

FORCE_METHODS = (("spm", 0, None, "`spm`, point, turns not limited"),
                 ("spm", 0, 120, "`spm`, point, as served: turns of at most 120 rad/s"),
                 ("paper", 0, None, "`paper`, point"), ("proxy", 0, None, "`proxy`, point"),
                 ("proxy", 0.0005, None, "`proxy`, ball of 0.5 mm"))
NOT_MEASURED = "Not measured yet for this version: `scripts/measure` writes it."
LABORATORY_METHODS = ("paper", "distance-field", "exact-penalty", "mesh-proxy", "spm", "proxy",
                      "default")


def span(values: Iterable[float]) -> str:
    """From the least to the largest, once where they look the same."""
    ordered = sorted(values)
    return " to ".join(dict.fromkeys((number(ordered[0]), number(ordered[-1]))))


def kilobytes(count: float) -> str:
    return f"{count / 1e3:,.0f} kB"


def megabytes(count: float) -> str:
    return f"{number(count / 1e6)} MB"


def find(rows: list[dict], **wanted) -> dict | None:
    return next((row for row in rows if all(row[key] == value for key, value in wanted.items())),
                None)


def made(reports: dict, *names: str) -> list[str]:
    """Where the figures of some reports come from: one line each."""
    lines = []
    for name in names:
        if name not in reports:
            continue
        what = reports[name]["made"]
        machine = what["machine"]
        lines.append(f"- `{name}.json`: {machine['processor']}, {machine['cores']} cores, "
                     f"{machine['system']}, {machine['compiler']}; commit `{what['commit']}`, "
                     f"`{what['command']}`")
    return lines


def system(reports: dict, release: str) -> str:
    """How a release of Debian does, as scripts/test-release found it."""
    row = find(reports["releases"]["rows"] if "releases" in reports else [], release=release)
    if row is None:
        return "not tried"
    if row["failed"] or any(row["exit_codes"].values()) or not row["tests"]:
        return "fails, as `scripts/test-release` found"
    test = "scripts/test"
    start = sum(minutes for command, minutes in itertools.takewhile(lambda item: item[0] != test,
                                                                    row["minutes"].items()))
    warm = ", with a compiler's cache" if row["compiled_before"] else ""
    return (f"{row['tests'] - len(row['skipped']):,} tests pass, {len(row['skipped'])} are skipped; the "
            f"start takes {number(start)} minutes, the tests {number(row['minutes'][test])}, on "
            f"{row['cores']} cores{warm} ({row['compiler']}, commit `{row['commit']}`)")


def bakes_table(reports: dict) -> list[str]:
    if "bakes" not in reports:
        return [NOT_MEASURED]

    def errors(row: dict) -> str:
        found = row["verify"]["distance_error_um"]
        return " / ".join(f"{found[key]:.{digits}f}" for key, digits in
                          (("p50", 1), ("p99", 0), ("p999", 0), ("max", 0)))

    def judged(row: dict, count) -> str:
        return " / ".join(count(of) for of in (row["verify"], row["verify"]["adversarial"]))

    def bake(row: dict) -> list[str]:
        mesh = find(reports["bytes"]["rows"], mesh=row["mesh"], method="raw-mesh")
        return [row["mesh"], f"{row['tolerance_um']:g} um", kilobytes(row["bytes"]),
                kilobytes(mesh["bytes"]) if mesh else "", f"{row['bake_processor_seconds']:.0f} s, "
                f"{megabytes(row['bake_peak_rss_bytes'])}"]

    rows = [[*bake(row), f"{100 * row['verify']['fallback_answers']:.0f} %", errors(row),
             f"{row['verify']['direction_error_deg']['p50']:.2f} / "
             f"{row['verify']['direction_error_deg']['p99']:.1f}",
             f"{row['verify']['adversarial']['distance_error_um']['max']:.0f}",
             judged(row, lambda of: f"{of['samples'] * of['unanswered']:.0f}"),
             judged(row, lambda of: number(100 * sum(of["misclassified"].values())))]
            for row in reports["bakes"]["rows"] if "verify" in row]
    rows += [[*bake(row), *[""] * 6] for row in reports["bakes"]["rows"] if "verify" not in row]
    return table(["mesh", "tolerance", "bytes", "mesh", "bake, processor time and memory",
                  "fallback",
                  "distance error p50 / p99 / p99.9 / max, um", "direction p50 / p99, deg",
                  "hard places: max, um",
                  "unanswered, places / hard places", "wrong side, %, places / hard places"], rows)


def wild_outcome(row: dict) -> str:
    """What became of a mesh that people have."""
    if not row:
        return ""
    if row["build"] != 0:
        return f"{row['build']}"
    return "kept" if row["verify"] == 0 else f"0, then {row['verify']}"


def wild_rows(reports: dict, folder: str) -> list[dict]:
    """What became of the meshes of a folder; none where they were not tried."""
    return [row for row in reports.get("wild", {}).get("rows", []) if row["folder"] == folder]


def wild_packages(reports: dict, folder: str) -> list[str]:
    """The meshes of a folder of packages, a row a package."""
    rows = wild_rows(reports, folder)
    if not rows:
        return [NOT_MEASURED]

    def cells(package: str) -> list[str]:
        own = [row for row in rows if row["mesh"].startswith(package + "/")]
        kept = [row for row in own if wild_outcome(row) == "kept"]
        refused = sum(row["build"] in (2, 3) for row in own)
        missed = len(own) - refused - len(kept)
        return [f"`{package}`", str(len(own)), str(refused), str(len(kept)), str(missed),
                f"{max((row['seconds'] for row in kept if row['triangles'] <= 20000), default=0):.0f} s"]

    return table(["package", "files", "refused in a sentence", "kept", "missed",
                  "longest kept up to 20,000 triangles"],
                 [cells(package) for package in sorted({row["mesh"].split("/")[0] for row in rows})])


def wild_missed(reports: dict, folder: str) -> list[str]:
    """Those of them that are neither kept nor refused."""
    rows = wild_rows(reports, folder)
    if not rows:
        return [NOT_MEASURED]
    missed = [row for row in rows if row["build"] not in (2, 3) and wild_outcome(row) != "kept"]
    return table(["mesh", "outcome", "processor time", "says"],
                 [[f"`{row['mesh'].split('/')[-1]}`", wild_outcome(row), f"{row['seconds']:.0f} s",
                   row["says"].replace("|", "/")] for row in missed])


def judges_table(reports: dict) -> list[str]:
    """Each judge: how many meshes it judged by its own rules, and where it disagrees."""
    rows = reports.get("judges", {}).get("rows", [])
    if not rows:
        return [NOT_MEASURED]

    def cells(judge: str) -> list[str]:
        own = [row for row in rows if row["judge"] == judge and "judged" in row]
        apart = [row for row in own if row["disagree"] > 0]
        return [judge, str(len(own)), f"{sum(row['judged'] for row in own):,}",
                str(sum(row["disagree"] for row in own)),
                ", ".join(f"`{row['mesh']}` {row['disagree']}" for row in apart)]

    judges = dict.fromkeys(row["judge"] for row in rows if "judged" in row)
    return table(["judge", "meshes", "places", "disagrees", "at"], [cells(judge) for judge in judges])


def wild_table(reports: dict, folder: str) -> list[str]:
    """Each mesh of a folder that people have, as an older program and this one took it."""
    rows = wild_rows(reports, folder)
    if not rows:
        return [NOT_MEASURED]

    def cells(row: dict) -> list[str]:
        before = row["before"]
        return [f"`{row['mesh']}`", f"{row['triangles']:,}" if "triangles" in row else "",
                wild_outcome(before), f"{before['seconds']:.1f} s" if before else "", wild_outcome(row),
                f"{row['seconds']:.1f} s"]

    return table(["mesh", "triangles", "before", "processor time", "now", "processor time"],
                 [cells(row) for row in rows])


def bake_times_table(reports: dict) -> list[str]:
    """Bakes of an older program and of this one, in turns, by stage."""
    if "bake_times" not in reports:
        return [NOT_MEASURED]

    def pair(row: dict, value) -> str:
        return " / ".join(number(value(row[which])) for which in ("before", "now"))

    stages = ("load", "fit", "cast", "verify", "write")
    return table(["mesh, tolerance", "in all, s", "now, of before", *(f"{stage}, s" for stage in stages),
                  "processor time, s", "file, kB", "memory, MB"],
                 [[f"{row['mesh']}, {row['tolerance_um']:g} um", pair(row, lambda run: run["seconds"]),
                   number(row["now"]["seconds"] / row["before"]["seconds"]),
                   *(pair(row, lambda run, stage=stage: run["stages"][stage]) for stage in stages),
                   pair(row, lambda run: run["processor_seconds"]),
                   pair(row, lambda run: run["bytes"] / 1e3),
                   pair(row, lambda run: run["peak_rss_bytes"] / 1e6)]
                  for row in reports["bake_times"]["rows"]])


def batches_table(reports: dict) -> list[str]:
    """Batches of the same meshes, beside one worker of one thread."""
    if "batches" not in reports:
        return [NOT_MEASURED]
    report = reports["batches"]
    base = report["runs"][0]["seconds"]
    rows = []
    for run in report["runs"]:
        workers = f"`-j {run['jobs']}`" + (f", `threads = {run['threads']}`" if run["threads"] else "")
        rows.append([run["what"], workers, f"{run['hits']} of {run['assets']}", number(run["seconds"]),
                     number(base / run["seconds"])])
    for run in report["clusters"]:
        rows.append([run["what"], f"{run['shards']} shards", "no cache", number(run["seconds"]),
                     number(base / run["seconds"])])
    return table(["batch", "workers", "from the cache", "s", "times as fast as the first"], rows)


def batches_facts(reports: dict) -> list[str]:
    """Load and kills, as a list."""
    if "batches" not in reports:
        return [NOT_MEASURED]
    report, killed = reports["batches"], reports["batches"]["killed"]
    return [f"- load of the machine before it began: {report['load_before']:.1f}",
            f"- kills at random moments: {killed['kills']}; the run after them took "
            f"{killed['hits_of_last']} of {killed['assets']} assets from the cache"]


def scale_assumptions(reports: dict) -> list[str]:
    """What the computation takes for granted, as a list."""
    if "batches" not in reports:
        return [NOT_MEASURED]
    assumed = reports["batches"]["scale"]["assumed"]
    return [f"- a node has {assumed['cores_a_node']} cores, as fast as those measured, and begins after "
            f"{number(assumed['start_seconds'])} s",
            f"- the file server bears {number(assumed['file_calls_a_second'])} file calls and "
            f"{megabytes(assumed['bytes_a_second'])} a second"]


def scale_table(reports: dict) -> list[str]:
    """What a library costs on more and more nodes."""
    if "batches" not in reports:
        return [NOT_MEASURED]
    rows = []
    for row in reports["batches"]["scale"]["rows"]:
        parts = row["parts_seconds"]
        rows.append([row["case"], number(row["nodes"]), duration(row["total_seconds"]),
                     *(duration(seconds) for seconds in parts.values()), row["bottleneck"]])
    names = list(reports["batches"]["scale"]["rows"][0]["parts_seconds"])
    return table(["library", "nodes", "in all", *names, "longest"], rows)


def duration(seconds: float) -> str:
    """In the largest unit of which there is one."""
    for unit, length in (("d", 86400), ("h", 3600), ("min", 60)):
        if seconds >= length:
            return f"{number(seconds / length)} {unit}"
    return f"{number(seconds)} s"


def own_row(methods: dict, mesh: str) -> dict:
    """The row of `spm` at the mesh's own tolerance."""
    tolerance = find(methods["meshes"], mesh=mesh)["tolerance_um"]
    return find(methods["rows"], mesh=mesh, method="spm", settings=f"tolerance {tolerance:g} um")


def hot_and_random(row: dict | None) -> str:
    return f"{row['ns']['hot']:,.0f} / {row['ns']['random']:,.0f}" if row else ""


def methods_table(reports: dict) -> list[str]:
    methods = reports["methods"]

    def cell(mesh: dict, method: str, settings: str) -> str:
        row = find(methods["rows"], mesh=mesh["mesh"], method=method, settings=settings)
        return f"{hot_and_random(row)} ({megabytes(row['bytes'])})" if row else ""

    rivals = (("triangle-grid", "cell 1 mm"), ("triangle-grid", "cell 600 um"),
              ("embree", "default"), ("dense-sdf", "cell 500 um"), ("openvdb", "voxel 500 um"),
              ("adaptive-sdf", "tolerance 200 um"))
    head = ["mesh, tolerance", "`spm`", *(f"`{name}`, {setting}" for name, setting in rivals)]
    return table(head,
                 [[f"{mesh['mesh']}, {mesh['tolerance_um']:g} um",
                   cell(mesh, "spm", own_row(methods, mesh["mesh"])["settings"]),
                   *(cell(mesh, *rival) for rival in rivals)] for mesh in methods["meshes"]])


def served_table(reports: dict) -> list[str]:
    """What a loop gets at each mesh's own tolerance, beside the fastest that keeps all triangles."""
    methods = reports["methods"]

    def cells(mesh: dict) -> list[str]:
        own = own_row(methods, mesh["mesh"])
        bake = find(reports["bakes"]["rows"], mesh=mesh["mesh"])
        embree, grids = ([row for row in methods["rows"]
                          if row["mesh"] == mesh["mesh"] and row["method"] == method]
                         for method in ("embree", "triangle-grid"))
        small = [row for row in grids if row["bytes"] <= 10 * own["bytes"]]

        def shares(rows: list[dict]) -> str:
            return " / ".join(number(own["ns"][state] / min(row["ns"][state] for row in rows))
                              for state in ("hot", "random"))

        return [f"{mesh['mesh']}, {mesh['tolerance_um']:g} um", megabytes(own["file_bytes"]),
                f"{1e3 * own['open_seconds']:.0f} ms", hot_and_random(own),
                f"{own['ns']['hot_p99']:,.0f}", shares(embree), shares(small) if small else "",
                f"{100 * bake['verify']['fallback_answers']:.0f} %", f"{bake['bake_seconds']:.1f} s"]

    return table(["mesh, tolerance", "file, of which all answers come", "opened in",
                  "a query along a path / at random places, ns", "p99 along the path, ns",
                  "of Embree's time", "of the time of exact triangles in lanes",
                  "answered by triangles", "baked in"],
                 [cells(mesh) for mesh in methods["meshes"]])


def batch_table(reports: dict) -> list[str]:
    methods = reports["methods"]

    def cells(mesh: dict) -> list[str]:
        settings = own_row(methods, mesh["mesh"])["settings"]
        return [hot_and_random(find(methods["rows"], mesh=mesh["mesh"], method=method,
                                    settings=settings + more))
                for method, more in (("spm", ""), ("spm", ", batch"), ("spm-scalar", ""))]

    return table(["mesh", "a point a call", "many points a call", "a point a call, without SIMD"],
                 [[mesh["mesh"], *cells(mesh)] for mesh in methods["meshes"]])


def probes_table(reports: dict) -> list[str]:
    rows = reports["methods"]["probe_rows"]
    names = list(dict.fromkeys(row["method"] for row in rows))
    return table(["mesh", *(f"`{name}`" for name in names)],
                 [[mesh, *(f"{row['ns']['hot']:,.0f}" if (row := find(rows, mesh=mesh, method=name))
                           else "" for name in names)]
                  for mesh in dict.fromkeys(row["mesh"] for row in rows)])


def accuracy_table(reports: dict) -> list[str]:
    """What `spm` answers at each tolerance that was measured."""
    rows = [row for row in reports["methods"]["rows"]
            if row["method"] == "spm" and not row["settings"].endswith("batch")]

    def cells(row: dict) -> list[str]:
        return [row["mesh"], f"{row['setting_um']:g} um",
                f"{row['depth_error_um']['p99']:.0f} / {row['depth_error_um']['max']:.0f}",
                f"{number(100 * row['unanswered'])} %", f"{number(100 * row['misclassified'])} %",
                megabytes(row["bytes"]), f"{1e3 * row['open_seconds']:.0f} ms"]

    return table(["mesh", "baked to", "distance error p99 / max, um", "unanswered",
                  "wrong side, of places farther than the mesh's tolerance", "file", "opened in"],
                 [cells(row) for row in rows])


def forces_table(reports: dict) -> list[str]:
    rows = reports["forces"]["rows"]

    def cell(**wanted) -> str:
        row = find(rows, **wanted)
        return (f"{number(100 * row['relative_difference'])} % / "
                f"{row['excess_step_n']['p999']:.2f} N / "
                f"{row['excess_step_clear_n']['p999']:.2f} N") if row else ""

    return table(["mesh", "method, probe",
                  "recorded slide: difference / excess step / judged alone",
                  "walked: the same"],
                 [[mesh, name, *(cell(mesh=mesh, path=path, method=method, probe_radius_m=radius,
                                      turn_limit_rad_per_s=limit)
                                 for path in ("recorded", "walked"))]
                  for mesh in dict.fromkeys(row["mesh"] for row in rows)
                  for method, radius, limit, name in FORCE_METHODS])


def culling_table(reports: dict) -> list[str]:
    return table(["scene", "objects", "pairs whose axis-aligned boxes meet",
                  "separated by oriented boxes", "by support planes", "us a pair"],
                 [[row["scene"], f"{row['objects']:,}", f"{row['after_aabb']:,}",
                   f"{100 * row['rejected_obb']:.0f} %", f"{100 * row['rejected_spm']:.0f} %",
                   f"{row['obb_ns'] / 1e3:.2f} / {row['spm_ns'] / 1e3:.2f}"]
                  for row in reports["sixdof"]["culling"]])


def laboratory_table(reports: dict) -> list[str]:
    """How many runs each method holds: of all it was tried in, and of those that all were tried in,
    where the shares have one denominator."""
    cases = reports["stability"]["cases"]
    stable = {(row["fraction"], row["method"], row["case"], device_of(row)): row["stable"]
              for row in cases}
    runs = dict.fromkeys((row["case"], device_of(row)) for row in cases)

    def cell(method: str, fraction: float, shared: bool) -> str:
        tried = [stable[fraction, method, *run] for run in runs
                 if all((fraction, other, *run) in stable
                        for other in (LABORATORY_METHODS if shared else (method,)))]
        good, count = sum(tried), len(tried)
        return f"{100 * good / count:.0f} %, {good} of {count}" if tried else ""

    return table(["", *(f"`{method}`" for method in LABORATORY_METHODS)],
                 [[f"good at {fraction:g}, of the runs {which}",
                   *(cell(method, fraction, shared) for method in LABORATORY_METHODS)]
                  for fraction in reports["stability"]["fractions"]
                  for which, shared in (("it had", False), ("that all had", True))])


def tools_table(reports: dict) -> list[str]:
    """The cases in six degrees of freedom at the fraction where the default is to hold: good runs of
    all profiles, with torque and without."""
    report = reports["tools"]
    rows = [row for row in report["cases"] if row["fraction"] == min(report["fractions"])]
    methods = [method for method in LABORATORY_METHODS
               if any(row["method"] == method for row in rows)]

    def cell(case: str | None, method: str) -> str:
        parts = []
        for torque in (True, False):
            good = [row["stable"] for row in rows if row["method"] == method
                    and case in (None, row["case"]) and row.get("torque", True) == torque]
            parts.append(f"{sum(good)} of {len(good)}" if good else "")
        return " / ".join(part for part in parts if part)

    cases = list(dict.fromkeys(row["case"] for row in rows))
    body = [[f"`{case}`", *(cell(case, method) for method in methods)] for case in cases]
    return table(["good, with torque / without", *(f"`{method}`" for method in methods)],
                 [*body, ["all", *(cell(None, method) for method in methods)]])


def default_table(reports: dict) -> list[str]:
    """What somebody gets who names no setting: at the stiffness that is chosen for the device."""
    report = reports["stability"]
    cases = stiffness_borders.cases(report)

    def cells(device: str) -> list[str]:
        stiffness = stiffness_borders.chosen(report, device)
        lost = [case for case in cases
                if stiffness_borders.border(report, case, "default", device) < stiffness]
        return [f"`{device}`", f"{stiffness / 1000:.2f}", f"{len(cases) - len(lost)} of {len(cases)}",
                ", ".join(f"`{case}`" for case in lost)]

    return table(["profile", "stiffness, N/mm", "cases that are held", "lost"],
                 [cells(device) for device in stiffness_borders.caps()])


def served_default_table(reports: dict) -> list[str]:
    """Which cases each profile holds with what an asset is served with where nothing is named."""
    if "served" not in reports:
        return [NOT_MEASURED]
    report = reports["served"]
    kinds = list(dict.fromkeys(row["case"] for row in report["teeth"]))

    def share(rows: list[dict]) -> str:
        return f"{sum(row['stable'] for row in rows)} of {len(rows)}"

    def cells(settings: dict) -> list[str]:
        device = settings["device"]
        teeth, shapes = ([row for row in report[which] if row["device"] == device]
                         for which in ("teeth", "catalogue"))
        lost = ", ".join(f"`{row['case']}`" for row in shapes if not row["stable"])
        return [f"`{device}`", f"{settings['stiffness_n_m'] / 1000:.2f}",
                *(share([row for row in teeth if row["case"] == kind]) for kind in kinds),
                share(shapes), lost]

    return table(["profile", "stiffness, N/mm", *(f"`{kind}`" for kind in kinds),
                  "of the catalogue", "lost there"], [cells(one) for one in report["settings"]])


def served_reasons(reports: dict) -> list[str]:
    """The teeth's runs that are not stable, and why."""
    if "served" not in reports:
        return [NOT_MEASURED]
    lost = [row for row in reports["served"]["teeth"] if not row["stable"]]
    if not lost:
        return ["No run on the teeth is lost."]
    return table(["case", "profile", "seeds that are good", "the worst one",
                  "at its end aside / below the surface, mm"],
                 [[f"`{row['case']}`", f"`{row['device']}`",
                   f"{row['good_seeds']} of {row['seeds']}", row["reason"],
                   f"{1e3 * row['end_aside_m']:.1f} / {1e3 * row['end_depth_m']:.1f}"]
                  for row in lost])


def costs_table(reports: dict) -> list[str]:
    costs = {row["method"]: row for row in reports["stability"]["costs"]}
    return table(["method", "a tick, mean / p99, us", "force off, median / RMS"],
                 [[f"`{method}`", f"{costs[method]['mean_us']:.2f} / {costs[method]['p99_us']:.1f}",
                   f"{number(100 * costs[method]['median_error'])} % / "
                   f"{number(100 * costs[method]['relative_error'])} %"]
                  for method in LABORATORY_METHODS if method in costs])


def soak_tables(reports: dict) -> list[str]:
    """What the soak programs found; they need real-time rights."""
    lines: list[str] = []
    for part in ("soaks", "crowds", "reactions", "daemon_streams", "views"):
        for name, text in reports.get(part, {}).get("tables", {}).items():
            lines += [f"`{name}.py`: {text[0].lstrip('# ')}", "", *text[2:], ""]
    return lines[:-1] or [NOT_MEASURED]


TABLES = {
    "accuracy_table": accuracy_table, "bake_times_table": bake_times_table,
    "bakes_table": bakes_table, "batch_table": batch_table,
    "batches_facts": batches_facts, "batches_table": batches_table,
    "scale_assumptions": scale_assumptions, "scale_table": scale_table,
    "costs_table": costs_table,
    "culling_table": culling_table, "forces_table": forces_table,
    "failing_table": lambda reports: failing_lines(reports["stability"])[2:-1],
    "default_table": default_table, "wild_table": wild_table, "judges_table": judges_table,
    "wild_packages": wild_packages, "wild_missed": wild_missed,
    "laboratory_table": laboratory_table, "made": made,
    "methods_table": methods_table,
    "probes_table": probes_table,
    "paper_tables": lambda reports: paper_tables(reports["tables"]),
    "scenes_table": lambda reports: scene_lines(reports["scenes"]),
    "served_default_table": served_default_table, "served_reasons": served_reasons,
    "served_table": served_table,
    "sixdof_table": lambda reports: sixdof_lines(reports["sixdof"]), "soak_tables": soak_tables,
    "stability_tables": lambda reports: stability_tables(reports["stability"]),
    "system": system,
    "targets_table": lambda reports: target_lines(reports["stability"])[2:-1],
    "tools_table": tools_table,
    "theory_table": lambda reports: theory_lines(reports["stability"])[4:-1],
}
