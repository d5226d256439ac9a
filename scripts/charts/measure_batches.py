#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures batches of 40 meshes made by seed: cold, warm and after one change, by one worker and by
two; through Slurm and Snakemake; killed at random moments; and what a manifest costs by itself. Then
computes what 100,000 such assets cost on a cluster (simulate_batches.py). Prints one JSON object.
Bytes that differ from those of one run are an error. SPM_BIN names the folder of the built programs.
Slurm needs root and the packages of scripts/packages/cluster.txt, and is left out without them."""

import argparse
import hashlib
import itertools
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
for folder in ("scripts", "scripts/charts", "tests/e2e", "tests/e2e/cluster"):
    sys.path.insert(0, str(SOURCE / folder))

import made_meshes  # noqa: E402
import simulate_batches  # noqa: E402

BIN = Path(os.environ.get("SPM_BIN", SOURCE / "build/release/bin")).resolve()
BAKE, CLUSTER = BIN / "spm-bake", SOURCE / "scripts/cluster"
SEED = 28
MESHES, KILLS, LISTED = (40, 4), (20, 3), (10_000, 500)  # in full, and for --quick
LEFT_OUT = ("chain", "bars")  # take ten times as long, or miss the tolerance in so deep a band
MANIFEST = """[defaults]
unit = "mm"
tolerance = "400um"
max-depth = "4mm"
margin = "1mm"
output = "{out}/{{stem}}.spm.exr"
[[asset]]
mesh = "{meshes}/*.obj"
"""


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def digests(folder: Path) -> dict[str, str]:
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(folder.glob("*.spm.exr"))}


class Bench:
    """A folder with meshes, and manifests that write to folders of their own."""

    def __init__(self, folder: Path, quick: bool) -> None:
        self.folder, self.quick = folder, quick
        self.clean: dict[str, str] = {}
        self.lines: list[dict] = []  # of the batch of two workers
        (folder / "meshes").mkdir()
        numbers = (number for number in itertools.count()
                   if made_meshes.KINDS[number % len(made_meshes.KINDS)].__name__ not in LEFT_OUT)
        for number in itertools.islice(numbers, MESHES[quick]):
            name = made_meshes.name_of(number, SEED)
            (folder / f"meshes/{name}.obj").write_text(
                made_meshes.to_obj(made_meshes.made_mesh(number, SEED)), encoding="ascii")

    def manifest(self, name: str, meshes: str = "meshes") -> Path:
        """A manifest with a folder for its outputs, both empty of what was before."""
        shutil.rmtree(self.folder / name, ignore_errors=True)
        (self.folder / name).mkdir()
        path = self.folder / f"{name}.toml"
        path.write_text(MANIFEST.format(out=name, meshes=meshes), encoding="ascii")
        return path

    def batch(self, manifest: Path, *options) -> tuple[float, list[dict]]:
        """Wall seconds, and the line of each asset."""
        begun = time.monotonic()
        done = subprocess.run([BAKE, "batch", manifest, "--json", *map(str, options)],
                              capture_output=True, text=True, check=False)
        seconds = time.monotonic() - begun
        if done.returncode != 0:
            sys.exit(f"measure_batches: spm-bake batch ended with {done.returncode}: {done.stderr}")
        return seconds, [json.loads(line) for line in done.stdout.splitlines()]

    def compare(self, what: str, folder: str) -> None:
        """Holds outputs to those of the first run."""
        found = digests(self.folder / folder)
        self.clean = self.clean or found
        if found != self.clean:
            sys.exit(f"measure_batches: {what} gave other bytes than one run")


def throughput(bench: Bench) -> list[dict]:
    """Each run: how many workers and threads, what the cache had, how long."""
    rows = []

    def run(what: str, name: str, jobs: int, cache: str, fresh: bool, *, threads: int = 0) -> list:
        say(f"batches: {what}, -j {jobs}" + (f", {threads} thread each" if threads else ""))
        manifest = bench.manifest(name) if fresh else bench.folder / f"{name}.toml"
        if threads:
            text = manifest.read_text(encoding="ascii")
            manifest.write_text(text.replace("[[asset]]", f"threads = {threads}\n[[asset]]"),
                                encoding="ascii")
        seconds, lines = bench.batch(manifest, "-j", jobs, "--cache", bench.folder / cache)
        rows.append({"what": what, "jobs": jobs, "threads": threads or None, "seconds": seconds,
                     "assets": len(lines), "hits": sum(line["cache"] == "hit" for line in lines)})
        return lines

    run("cold", "single", 1, "cache-single", True, threads=1)
    bench.compare("one worker of one thread", "single")
    run("cold", "one", 1, "cache-one", True)
    bench.compare("-j 1", "one")
    run("warm", "one", 1, "cache-one", False)
    lines = run("cold", "two", 2, "cache-two", True)
    bench.compare("-j 2", "two")
    run("warm", "two", 2, "cache-two", False)
    run("other folder", "again", 2, "cache-two", True)
    bench.compare("a cache", "again")
    changed = sorted((bench.folder / "meshes").iterdir())[0]
    before = changed.read_bytes()
    changed.write_bytes(before + b"# one mesh changed\n")
    run("one mesh changed", "two", 2, "cache-two", False)
    changed.write_bytes(before)
    bench.lines = lines
    return rows


def killed(bench: Bench, cold: float) -> dict:
    """A batch that is killed again and again, then runs to its end."""
    say("batches: killed at random moments")
    moments = random.Random(SEED)
    manifest = bench.manifest("killed")
    command = [BAKE, "batch", manifest, "-j", "2", "--quiet", "--cache", bench.folder / "cache-killed"]
    seconds, finished = [], 0
    while len(seconds) < KILLS[bench.quick]:
        moment = moments.uniform(0, 2 * cold / KILLS[bench.quick])
        process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
        try:
            process.wait(timeout=moment)
            # It was done before: once more from nothing.
            finished += 1
            shutil.rmtree(bench.folder / "cache-killed")
            manifest = bench.manifest("killed")
            continue
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
            process.wait()
        seconds.append(moment)
        for name, digest in digests(bench.folder / "killed").items():
            if digest != bench.clean[name]:
                sys.exit(f"measure_batches: a kill left {name} with other bytes")
        strange = [path.name for path in (bench.folder / "killed").iterdir()
                   if not path.name.endswith(".spm.exr")]
        if strange:
            sys.exit(f"measure_batches: a kill left {strange}")
    last, lines = bench.batch(manifest, "-j", 2, "--cache", bench.folder / "cache-killed")
    bench.compare("a run after kills", "killed")
    return {"kills": len(seconds), "at_seconds": seconds, "ended_before": finished, "last_seconds": last,
            "hits_of_last": sum(line["cache"] == "hit" for line in lines), "assets": len(lines)}


def clusters(bench: Bench) -> list[dict]:
    """Slurm and Snakemake, each without a cache."""
    rows = []
    environment = {**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}:/usr/sbin:/sbin"}

    def run(what: str, shards: int, *command) -> None:
        say(f"batches: {what}")
        begun = time.monotonic()
        done = subprocess.run([*map(str, command)], cwd=bench.folder, env=environment,
                              capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(f"measure_batches: {what} ended with {done.returncode}: {done.stderr}")
        seconds = time.monotonic() - begun
        rows.append({"what": what, "shards": shards, "seconds": seconds, "assets": len(bench.clean)})

    if shutil.which("snakemake"):
        bench.manifest("snakemake")
        run("Snakemake", 2, "snakemake", "-s", CLUSTER / "Snakefile", "--cores", 2, "--config",
            "manifest=snakemake.toml", "shards=2")
        bench.compare("Snakemake", "snakemake")
        shutil.rmtree(bench.folder / "spm-results")
    os.environ["PATH"] = environment["PATH"]
    if os.geteuid() == 0 and all(map(shutil.which, ("munged", "slurmctld", "slurmd", "sbatch"))):
        from slurm_here import SlurmHere
        (bench.folder / "slurm-here").mkdir()
        slurm = SlurmHere(str(bench.folder / "slurm-here"))
        try:
            environment = {**environment, **slurm.environment, "PATH": environment["PATH"]}
            bench.manifest("slurm")
            run("Slurm", 4, CLUSTER / "bake_on_slurm", 4, "slurm.toml", "--cpus-per-task=1")
            bench.compare("Slurm", "slurm")
        finally:
            slurm.stop()
    return rows


def costs(bench: Bench) -> dict:
    """What an asset takes besides its bake, s."""
    say("batches: what manifests and merging take")
    count = LISTED[bench.quick]
    (bench.folder / "listed").mkdir()
    first = sorted((bench.folder / "meshes").iterdir())[0]
    for number in range(count):
        os.link(first, bench.folder / f"listed/{number:06}.obj")
    manifest = bench.manifest("listing", "listed")
    found: dict = {"listed": count}
    rehearse = [BAKE, "batch", manifest, "--dry-run", "--quiet", "--shard", f"1/{count}"]
    begun = time.monotonic()
    subprocess.run(rehearse, check=True)
    found["shard_seconds"] = (time.monotonic() - begun) / count
    if shutil.which("strace"):
        counts = bench.folder / "calls.txt"
        subprocess.run(["strace", "-f", "-c", "-e", "trace=%file", "-o", counts, *rehearse],
                       check=True, stderr=subprocess.DEVNULL)
        total = [line for line in counts.read_text().splitlines() if line.endswith(" total")]
        found["shard_file_calls"] = int(total[0].split()[3]) / count
    manifest = bench.manifest("merged")
    result = bench.folder / "merged.json"
    bench.batch(manifest, "-j", 2, "--cache", bench.folder / "cache-two", "--result", result)
    begun = time.monotonic()
    subprocess.run([BAKE, "merge", manifest, result, "--quiet"], check=True)
    found["merge_seconds"] = (time.monotonic() - begun) / len(bench.clean)
    shutil.rmtree(bench.folder / "listed")
    return found


def assets(bench: Bench) -> list[dict]:
    """What the bakes of two workers took, each on one core, and what was guessed."""
    rehearsed = bench.batch(bench.folder / "two.toml", "--dry-run")[1]
    return [{"name": line["name"], "triangles": line["mesh"]["triangles"],
             "seconds": line["seconds"]["total"], "estimate": guess["estimate"]["seconds"],
             "mesh_bytes": os.path.getsize(line["mesh"]["path"]), "bytes": line["bytes"]}
            for line, guess in zip(bench.lines, rehearsed)]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few meshes")
    arguments = parser.parse_args()
    load = os.getloadavg()[0]
    with tempfile.TemporaryDirectory(prefix="spm-batches-") as folder:
        bench = Bench(Path(folder), arguments.quick)
        report: dict = {"seed": SEED, "runs": throughput(bench)}
        cold = next(row["seconds"] for row in report["runs"]
                    if row["what"] == "cold" and row["jobs"] == 2)
        report["killed"] = killed(bench, cold)
        report["clusters"] = clusters(bench)
        report["costs"] = costs(bench)
        report["assets"] = assets(bench)
    report["scale"] = simulate_batches.simulate(report)
    # Above 2 or so before it began, something else ran, and the times are too long.
    report["load_before"] = load
    print(json.dumps(report))
    return 0


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    sys.exit(main())
