# SPDX-License-Identifier: Apache-2.0
"""How deep points are in an asset, all in one call: touch.py ASSET COUNT."""

import sys

import numpy
from spm_query import Asset, Status

with Asset(sys.argv[1]) as asset:
    low, high = map(numpy.array, asset.box)
    count = int(sys.argv[2])
    points = low + (high - low) * numpy.random.default_rng(1).random((count, 3))
    answers = asset.query(points)
    inside = int((answers["distance"] < 0).sum())
    exact = int((answers["status"] == Status.EXACT).sum())
    print(f"{len(answers)} points, {inside} inside, {exact} exact")
