#!/usr/bin/env python3
"""Compares grainsmooth with Surface Evolver on periodic networks of random grains.

    cargo build --release
    python3 benches/peers/evolver.py --rng-seed 1 2 3

Both minimise area at fixed volumes, on the same topology and at the same number of triangles. Evolver begins with our control
mesh (-n 0) and refines it as often as we subdivide, without topological events. Two cases:

equilibrium  ours is --relax equilibrium; Evolver begins with the topology that this ends with
no events    ours is --relax 10 on the regularised network; Evolver begins with that network, flat

Seconds are of processor time, of whole runs. Needs `evolver` on the path, and nothing beyond Python's own library.
"""

import argparse
import math
import os
import re
import resource
import subprocess
import sys
import tempfile
from collections import defaultdict

# What our relaxation to equilibrium calls a standstill too.
STANDSTILL = 1e-5
# Of coarse meshes only the slow motion of whole grains is wanted.
ROUNDS = {"coarse": 5, "finest": 12}

CASES = {
    "equilibrium": {"ours": "equilibrium", "start": "equilibrium"},
    # So short a time leaves the regularised network flat; 0 would not regularise it.
    "no events": {"ours": "10", "start": "1e-9"},
}


def measured(command, **options):
    """Runs a command; what it said, and the processor time that it took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    done = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    if done.returncode != 0:
        sys.exit(f"{command[0]} failed: {done.stderr.strip()}")
    return done.stdout, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def grainsmooth(program, grains, seed, relax, levels, path):
    """Makes a network as a datafile; the processor time."""
    command = [program, "--seeds", str(grains), "--periodic", "x,y,z", "--rng-seed", str(seed)]
    _, seconds = measured([*command, "--relax", relax, "-n", str(levels), "-o", path])
    return seconds


def boundaries(path):
    """The sides of all boundaries, which is the topology as far as a comparison can get it wrong."""
    with open(path, encoding="utf-8") as file:
        return [line for line in file if line.startswith("// boundary ")]


def script(levels, dump):
    """Evolver's commands: on each refinement, rounds of grooming, conjugate gradients and Newton's method."""
    lines = ["quiet", "U", "g 10"]
    for level in range(levels + 1):
        rounds = ROUNDS["finest" if level == levels else "coarse"]
        lines += ["r"] * (level > 0)
        lines += [
            "round := 0; old := 2*total_area;",
            f"while (round < {rounds} and abs(old/total_area - 1) > {STANDSTILL}) do {{"
            "old := total_area; round += 1; V; u; g 10; hessian_seek;"
            f'printf "round {level} %.12g %.6g\\n", total_area, clock }};',
        ]
    lines += [
        'printf "found %d %.3g\\n", facet_count, max(body, abs(volume/target - 1));',
        f'dump "{dump}"',
        "q",
        "q",
    ]
    return "\n".join(lines) + "\n"


def evolver(path, levels, dump):
    """Converges; the rounds as (level, area, seconds), and the largest relative error of a volume."""
    said, _ = measured(["evolver", path], input=script(levels, dump))
    number = r"([-+.e\d]+)"
    rounds = re.findall(rf"^round (\d) +{number} +{number}$", said, re.MULTILINE)
    error = float(re.search(rf"^found \d+ +{number}$", said, re.MULTILINE).group(1))
    return [(int(level), float(area), float(seconds)) for level, area, seconds in rounds], error


class Mesh:
    """A datafile of the torus model with sides of length 1, ours or a dump of Evolver's."""

    def __init__(self, path):
        points, self.edges, self.faces = {}, {}, []
        section = None
        with open(path, encoding="utf-8") as file:
            for line in file:
                words = re.sub(r"//.*|/\*.*?\*/", "", line).split()
                if not words:
                    continue
                if words[0] in ("vertices", "edges", "faces", "bodies"):
                    section = words[0]
                elif section == "vertices":
                    points[words[0]] = [float(word) for word in words[1:4]]
                elif section == "edges":
                    start, end = points[words[1]], points[words[2]]
                    wraps = ["-*+".index(word) - 1 for word in words[3:6]]
                    vector = [b + wrap - a for a, b, wrap in zip(start, end, wraps)]
                    self.edges[int(words[0])] = vector
                elif section == "faces":
                    self.faces.append([int(word) for word in words[1:4]])

    def vector(self, edge):
        vector = self.edges[abs(edge)]
        return vector if edge > 0 else [-x for x in vector]

    def area(self):
        return sum(math.hypot(*cross(self.vector(a), self.vector(b))) for a, b, _ in self.faces) / 2

    def angle_spread(self):
        """Standard deviation from 120 degrees of the angles at edges where three faces meet, weighted by length."""
        apexes = defaultdict(list)
        for face in self.faces:
            for edge, following in zip(face, face[1:] + face[:1]):
                # From the edge's line to the third corner.
                apexes[abs(edge)].append(self.vector(following))
        weights = squares = 0.0
        for edge, legs in apexes.items():
            if len(legs) != 3:
                continue
            length = math.hypot(*self.edges[edge])
            axis = [x / length for x in self.edges[edge]]
            zero = cross(axis, legs[0])
            quarter = cross(axis, zero)
            turns = sorted(math.atan2(dot(leg, zero), -dot(leg, quarter)) for leg in legs)
            ends = [*turns[1:], turns[0] + math.tau]
            weights += 3 * length
            squares += length * sum((math.degrees(b - a) - 120) ** 2 for a, b in zip(turns, ends))
        return math.sqrt(squares / weights)


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def compare(case, relax, seed, options, folder):
    """One line of the table."""
    fine, coarse, dump = (os.path.join(folder, name) for name in ("fine.fe", "coarse.fe", "converged.dmp"))
    seconds = grainsmooth(options.program, options.grains, seed, relax["ours"], options.levels, fine)
    grainsmooth(options.program, options.grains, seed, relax["start"], 0, coarse)
    if boundaries(fine) != boundaries(coarse):
        sys.exit(f"--rng-seed {seed}: the control mesh has another topology than the finer one")
    rounds, error = evolver(coarse, options.levels, dump)
    ours, theirs = Mesh(fine), Mesh(dump)
    area, (_, least, converged) = ours.area(), rounds[-1]
    as_good = next((f"{at:.0f}" for _, reached, at in rounds if reached <= area), "never")
    print(
        f"| {case} | {seed} | {len(ours.faces)} | {area:.5f} | {least:.5f} | {100 * (area / least - 1):+.3f} | {error:.0e} "
        f"| {ours.angle_spread():.2f} | {theirs.angle_spread():.2f} | {seconds:.1f} | {as_good} | {converged:.0f} |",
        flush=True,
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="target/release/grainsmooth")
    parser.add_argument("--grains", type=int, default=60)
    parser.add_argument("--levels", type=int, default=2)
    parser.add_argument("--rng-seed", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--case", choices=CASES, nargs="+", default=list(CASES))
    options = parser.parse_args()
    print(
        "| case | seed | triangles | our area | Evolver's | difference, % | its volumes' error | our angles' sd "
        "| Evolver's | our seconds | Evolver's to our area | to standstill |"
    )
    print("|" + "---|" * 12)
    with tempfile.TemporaryDirectory() as folder:
        for case in options.case:
            for seed in options.rng_seed:
                compare(case, CASES[case], seed, options, folder)


if __name__ == "__main__":
    main()
