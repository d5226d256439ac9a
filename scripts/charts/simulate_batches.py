#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What 100,000 assets cost on 1, 10 and 1,000 nodes, from measured bakes. The assets are drawn by
seed from those that were measured, with their times and sizes; shards are formed by what
spm-bake guesses that each takes, as it does itself, and take what was measured. All nodes share one
file server, of which ASSUMED says what it bears. Usage: simulate_batches.py batches.json prints the
rows of a report that was measured before."""

import heapq
import json
import random
import sys

ASSETS, NODES, SEED = 100_000, (1, 10, 1000), 100_000
# Not measured: nodes like the machine that was measured, and a file server as laboratories have.
ASSUMED = {"cores_a_node": 2, "file_calls_a_second": 50_000, "bytes_a_second": 1e9,
           "start_seconds": 5}
CASES = {"all new": 1.0, "1 % changed": 0.01, "nothing changed": 0.0}


def shards_of(guesses: list[float], count: int) -> list[list[int]]:
    """As baker/batch/shards.cpp: the dearest first, each to the shard that has least."""
    loads = [(0.0, shard) for shard in range(count)]
    shards: list[list[int]] = [[] for _ in range(count)]
    for asset in sorted(range(len(guesses)), key=lambda i: -guesses[i]):
        load, shard = loads[0]
        heapq.heapreplace(loads, (load + guesses[asset], shard))
        shards[shard].append(asset)
    return shards


def makespan(seconds: list[float], workers: int) -> float:
    """Of jobs that begin in their order, each where a worker is free."""
    free = [0.0] * workers
    for one in seconds:
        heapq.heapreplace(free, free[0] + one)
    return max(free)


def simulate(report: dict) -> dict:
    chance = random.Random(SEED)
    measured, costs = report["assets"], report["costs"]
    warm = next(row for row in report["runs"] if row["what"] == "warm" and row["jobs"] == 1)
    hit = warm["seconds"] / warm["assets"]
    drawn = [chance.choice(measured) for _ in range(ASSETS)]
    calls = costs.get("shard_file_calls", 0)
    rows = []
    for nodes in NODES:
        shards = shards_of([asset["estimate"] for asset in drawn], nodes)
        for case, share in CASES.items():
            new = [chance.random() < share for _ in range(ASSETS)]
            baking = [makespan([drawn[i]["seconds"] if new[i] else hit for i in shard],
                               ASSUMED["cores_a_node"]) for shard in shards]
            moved = sum(asset["mesh_bytes"] + (2 * asset["bytes"] if is_new else asset["bytes"])
                        for asset, is_new in zip(drawn, new))
            # Each shard reads the whole manifest and looks at every mesh.
            parts = {"bakes": max(baking), "manifest": costs["shard_seconds"] * ASSETS,
                     "file server's calls": nodes * calls * ASSETS / ASSUMED["file_calls_a_second"],
                     "file server's bytes": moved / ASSUMED["bytes_a_second"],
                     "merge": costs["merge_seconds"] * ASSETS}
            beside = max(parts["bakes"], parts["file server's bytes"])
            total = (ASSUMED["start_seconds"] + max(parts["manifest"], parts["file server's calls"]) +
                     beside + parts["merge"])
            rows.append({"nodes": nodes, "case": case, "total_seconds": total, "parts_seconds": parts,
                         "bottleneck": max(parts, key=lambda part: parts[part]),
                         "bakes_mean_seconds": sum(baking) / nodes,
                         "core_hours": sum(drawn[i]["seconds"] for i in range(ASSETS) if new[i]) / 3600})
    return {"assets": ASSETS, "seed": SEED, "assumed": ASSUMED, "hit_seconds": hit, "rows": rows}


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as file:
        print(json.dumps(simulate(json.load(file))))
