"""Quality and time of finite-element meshes: the rows of a table in README.md.

python benches/finite_elements.py PROGRAM [--grains 200] [--per-grain 5] [--levels 2] [--seeds 5] [--cases box,equilibrium,whole,cut,gmsh,"gmsh flat"]

A row is a case: medians over random seeds, and the worst of what must not happen. The last two columns are the processor time of a whole run with Gmsh's, and of that the time of remeshing. The cases "gmsh"
and "gmsh flat" are Gmsh alone, which fills grains between the triangles of their control mesh (-n 0), or of flat cells (--relax 0), as they are; its own time stands in the last column.
"""

import argparse
import json
import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile

CASES = {
    "box": [],
    "equilibrium": ["--relax", "equilibrium"],
    "regularized": ["--regularize", "0.15"],
    "whole": ["--periodic", "x,y,z"],
    "whole equilibrium": ["--periodic", "x,y,z", "--relax", "equilibrium"],
    "cut": ["--periodic", "x,y,z", "--periodic-cut", "box"],
    "cut equilibrium": ["--periodic", "x,y,z", "--periodic-cut", "box", "--relax", "equilibrium"],
}


def processor_time(command, folder):
    """Runs a command; returns its processor time and whether it succeeded, with what it said."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    time = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    return time, run.returncode == 0, run.stderr


def meshed(program, options, folder):
    """What a run tells of its mesh; nothing where it fails."""
    command = [os.path.abspath(program), *options, "--volume-mesh", "-o", "a.vtu", "--json-summary", "a.json", "-q"]
    time, is_good, said = processor_time(command, folder)
    if not is_good:
        print(said.strip(), file=sys.stderr)
        return None
    with open(os.path.join(folder, "a.json")) as file:
        summary = json.load(file)
    tetrahedra, triangles = summary["tetrahedra"], summary["triangle_angles"]
    return {
        "triangles": summary["elements"],
        "angle": triangles["first_percentile"],
        "least angle": triangles["least"],
        "volumes": summary["largest_relative_volume_error"],
        "tetrahedra": tetrahedra["count"],
        "gamma": tetrahedra["mean"],
        "gamma of a hundredth": tetrahedra["first_percentile"],
        "below 0.1": tetrahedra["below_tenth"],
        "least gamma": tetrahedra["least"],
        "processor time": time,
        "remeshing": summary["seconds"]["remeshing"],
    }


def filled_by_gmsh(program, options, folder):
    """The same of triangles that are not remeshed, between which Gmsh alone fills grains, by HXT; nothing where it fails."""
    coarse = [*options, "-n", "0", "-o", "a.msh", "--json-summary", "a.json", "-q"]
    made, is_good, said = processor_time([os.path.abspath(program), *coarse], folder)
    gmsh = ["gmsh", "-3", "-nt", "1", "-v", "1", "-format", "msh41", "-setnumber", "Mesh.Algorithm3D", "10"]
    filling, is_filled, _ = processor_time([*gmsh, "-o", "filled.msh", "a.geo"], folder)
    if not is_good or not is_filled:
        print(said.strip() or "Gmsh fails", file=sys.stderr)
        return None
    check = [os.path.abspath(program), "check", "--json", "filled.msh"]
    report = json.loads(subprocess.run(check, cwd=folder, capture_output=True, text=True).stdout)["files"][0]
    with open(os.path.join(folder, "a.json")) as file:
        summary = json.load(file)
    tetrahedra, triangles = report["quality"], summary["triangle_angles"]
    return {
        "triangles": summary["elements"],
        "angle": triangles["first_percentile"],
        "least angle": triangles["least"],
        "volumes": math.nan,
        "tetrahedra": tetrahedra["count"],
        "gamma": tetrahedra["mean"],
        "gamma of a hundredth": tetrahedra["first_percentile"],
        "below 0.1": tetrahedra["below_tenth"],
        "least gamma": tetrahedra["least"],
        "processor time": made + filling,
        "remeshing": filling,
    }


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--grains", default="200")
    parser.add_argument("--per-grain", default="5")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--levels", default="2")
    parser.add_argument("--cases", default="box,equilibrium,whole,cut")
    arguments = parser.parse_args()
    for case in arguments.cases.split(","):
        found = []
        for seed in range(1, arguments.seeds + 1):
            options = ["--seeds", arguments.grains, "--seeding", "random", "--rng-seed", str(seed)]
            with tempfile.TemporaryDirectory() as folder:
                if case.startswith("gmsh"):
                    options += ["--relax", "0"] if case == "gmsh flat" else []
                    found.append(filled_by_gmsh(arguments.program, options, folder))
                    continue
                options += ["-n", arguments.levels, "--elements-per-grain", arguments.per_grain, *CASES[case]]
                found.append(meshed(arguments.program, options, folder))
        good = [row for row in found if row]
        if not good:
            print(f"| {case} | 0 of {len(found)} filled |")
            continue
        median = {name: statistics.median(row[name] for row in good) for name in good[0]}
        bad = sum(row["below 0.1"] for row in good)
        least = [min(row[name] for row in good) for name in ("least angle", "least gamma")]
        volumes = max(row["volumes"] for row in good)
        print(
            f"| {case} | {len(good)} of {len(found)} | {median['triangles']:.0f} | {median['angle']:.1f} | {least[0]:.1f} "
            f"| {volumes:.0e} | {median['tetrahedra']:.0f} | {median['gamma']:.3f} | {median['gamma of a hundredth']:.3f} "
            f"| {bad} | {least[1]:.3f} | {median['processor time']:.1f} | {median['remeshing']:.1f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
