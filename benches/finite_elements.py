"""Quality and time of finite-element meshes: the rows of a table in README.md, beside what is wanted.

python benches/finite_elements.py PROGRAM [WORD ...] [--seeds 3]

Runs the rows whose names contain all words, as "200 box D/5" or "equilibrium"; "alone" runs those of Gmsh alone. A row shows medians over random seeds, and the worst of what must not happen; bold is what misses its target.
Needs NumPy, PyVista and Gmsh.
"""

import argparse
import itertools
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np
import pyvista

DOMAINS = {"box": [], "whole": ["--periodic", "x,y,z"], "cut": ["--periodic", "x,y,z", "--periodic-cut", "box"]}
RELAXATIONS = {"default": [], "regularized": ["--regularize", "0.15"], "equilibrium": ["--relax", "equilibrium"]}
# Levels of which the finest has edges no longer than 0.4 of an element.
LEVELS = {5: 2, 10: 3}

ROWS = list(itertools.product([200], DOMAINS, RELAXATIONS, LEVELS))
ROWS += itertools.product([1000], ["whole"], RELAXATIONS, LEVELS)
ROWS += itertools.product([10000], ["box"], ["default", "regularized"], [5])

# Gmsh alone, between the triangles of the control mesh, relaxed and of flat cells.
ALONE = {"200 box alone": [], "200 box alone flat": ["--relax", "0"]}

# Seconds of remeshing, by grains and elements to a diameter.
SECONDS = {(200, 5): 4, (200, 10): 9, (1000, 5): 20, (1000, 10): 45, (10000, 5): 240}

COLUMNS = [
    "", "filled", "triangles", "angle, 1 %", "mean", "least", "narrow, %", "volumes", "off, rms", "off, largest", "tetrahedra",
    "gamma, mean", "1 %", "< 0.1", "least", "run, s", "remeshing, s", "filling, s", "GB",
]  # fmt: skip


def run(command, folder):
    """Runs a command; returns its seconds by the clock, its memory in GB, whether it succeeded, and what it said."""
    start = time.perf_counter()
    with open(os.path.join(folder, "said"), "w+") as said:
        process = subprocess.Popen(command, cwd=folder, stdout=said, stderr=said)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        text = said.read().strip()
    return time.perf_counter() - start, used.ru_maxrss / 1e6, process.returncode == 0, text


def least_angles(surface):
    """The least angle of each triangle, in degrees."""
    corners = surface.points[surface.faces.reshape(-1, 4)[:, 1:]]
    sides = [corners[:, (k + 1) % 3] - corners[:, k] for k in range(3)]
    unit = [side / np.linalg.norm(side, axis=1)[:, None] for side in sides]
    cosines = [-np.sum(unit[k] * unit[k - 1], axis=1) for k in range(3)]
    return np.degrees(np.arccos(np.clip(np.max(cosines, axis=0), -1, 1)))


def distances(surface, smooth):
    """How far points are from the smooth surface of their own boundary."""
    all_distances = []
    of_surface, of_smooth = surface.cell_data["BoundaryId"], smooth.cell_data["BoundaryId"]
    triangles, fine = (mesh.faces.reshape(-1, 4) for mesh in (surface, smooth))
    orders = [np.argsort(ids, kind="stable") for ids in (of_surface, of_smooth)]
    for boundary in np.unique(of_surface):
        own, under = (
            cells[order[np.searchsorted(ids[order], boundary) : np.searchsorted(ids[order], boundary + 1)]]
            for cells, ids, order in ((triangles, of_surface, orders[0]), (fine, of_smooth, orders[1]))
        )
        points = surface.points[np.unique(own[:, 1:])]
        _, nearest = pyvista.PolyData(smooth.points, under.ravel()).find_closest_cell(points, return_closest_point=True)
        all_distances.append(np.linalg.norm(nearest - points, axis=1))
    return np.concatenate(all_distances)


def meshed(program, row, seed, folder):
    """What a run tells of its mesh; nothing where it fails."""
    grains, domain, relaxation, per_grain = row
    network = ["--seeds", str(grains), "--seeding", "random", "--rng-seed", str(seed), "-n", str(LEVELS[per_grain])]
    network = [os.path.abspath(program), *network, *DOMAINS[domain], *RELAXATIONS[relaxation], "-q"]
    elements = ["--elements-per-grain", str(per_grain), "--volume-mesh", "-o", "a.vtu", "-o", "a.vtp", "--json-summary", "a.json"]
    seconds, memory, is_good, said = run([*network, *elements], folder)
    if not is_good:
        print(row, "seed", seed, said, file=sys.stderr)
        return None
    with open(os.path.join(folder, "a.json")) as file:
        summary = json.load(file)
    surface = pyvista.read(os.path.join(folder, "a.vtp"))
    angles = least_angles(surface)
    found = {"off, rms": float("nan"), "off, largest": float("nan")}
    # Without elements, boxes are cut by other planes.
    if seed == 1 and grains <= 1000 and domain != "cut" and run([*network, "-o", "smooth.vtp"], folder)[2]:
        off = distances(surface, pyvista.read(os.path.join(folder, "smooth.vtp"))) / summary["element_size"]["size"]
        found = {"off, rms": float(np.sqrt(np.mean(off**2))), "off, largest": float(off.max())}
    tetrahedra, stages = summary["tetrahedra"], summary["seconds"]
    return {
        **found,
        "triangles": summary["elements"],
        "angle, 1 %": float(np.percentile(angles, 1)),
        "mean": float(angles.mean()),
        "least angle": float(angles.min()),
        "narrow, %": 100 * float(np.mean(angles < (30 if relaxation == "equilibrium" else 20))),
        "volumes": summary["largest_relative_volume_error"],
        "tetrahedra": tetrahedra["count"],
        "gamma, mean": tetrahedra["mean"],
        "1 %": tetrahedra["first_percentile"],
        "< 0.1": tetrahedra["below_tenth"],
        "least": tetrahedra["least"],
        "run, s": seconds,
        "remeshing, s": stages["remeshing"],
        "filling, s": stages["filling"],
        "GB": memory,
    }


def alone(program, options, seed, folder):
    """What Gmsh makes by itself, by HXT, between triangles that are not remeshed; nothing where it fails."""
    network = ["--seeds", "200", "--seeding", "random", "--rng-seed", str(seed), "-n", "0", *options, "-q"]
    seconds, _, _, _ = run([os.path.abspath(program), *network, "-o", "a.msh", "-o", "a.vtp"], folder)
    gmsh = ["gmsh", "-3", "-nt", "1", "-v", "1", "-format", "msh41", "-setnumber", "Mesh.Algorithm3D", "10"]
    filling, memory, is_filled, said = run([*gmsh, "-o", "filled.msh", "a.geo"], folder)
    if not is_filled:
        print("Gmsh alone", options, "seed", seed, said, file=sys.stderr)
        return None
    check = [os.path.abspath(program), "check", "--json", "filled.msh"]
    quality = json.loads(subprocess.run(check, cwd=folder, capture_output=True, text=True).stdout)["files"][0]["quality"]
    angles = least_angles(pyvista.read(os.path.join(folder, "a.vtp")))
    return [
        len(angles), float(np.percentile(angles, 1)), float(angles.mean()), float(angles.min()), 100 * float(np.mean(angles < 20)),
        quality["count"], quality["mean"], quality["first_percentile"], quality["below_tenth"], quality["least"], seconds, filling, memory,
    ]  # fmt: skip


def shown_alone(name, found, count):
    """The same columns, without targets."""
    median = [statistics.median(values) for values in zip(*found)]
    count_of, one, mean, least, narrow, tetrahedra, gamma, gamma_one, _, _, seconds, filling, memory = median
    bad, worst = sum(values[8] for values in found), min(values[9] for values in found)
    return (
        f"| {name} | {len(found)} of {count} | {count_of:.0f} | {one:.1f} | {mean:.1f} | {least:.1f} | {narrow:.3f} | | | | {tetrahedra:.0f} "
        f"| {gamma:.3f} | {gamma_one:.3f} | {bad} | {worst:.3f} | {seconds:.1f} | | {filling:.1f} | {memory:.2f} |"
    )


def shown(row, found, count):
    """A row of the table; what misses its target is bold."""
    grains, domain, relaxation, per_grain = row
    is_cut, is_equilibrium, is_fine = domain == "cut", relaxation == "equilibrium", per_grain == 10
    median = {name: statistics.median(run[name] for run in found) for name in found[0]}
    least = {name: min(run[name] for run in found) for name in ("least angle", "least")}
    largest = {name: max(run[name] for run in found) for name in found[0]}
    bad, tetrahedra = (sum(run[name] for run in found) for name in ("< 0.1", "tetrahedra"))
    off = found[0]
    cells = [
        (f"{len(found)} of {count}", len(found) == count),
        (f"{median['triangles']:.0f}", True),
        (f"{median['angle, 1 %']:.1f}", median["angle, 1 %"] >= (25 if is_cut else 36 if is_fine else 34)),
        (f"{median['mean']:.1f}", is_cut or median["mean"] >= (49 if is_fine else 47)),
        (f"{least['least angle']:.1f}", True),
        (f"{median['narrow, %']:.3f}", is_cut or median["narrow, %"] <= (0.05 if is_equilibrium else 0.1)),
        (f"{largest['volumes']:.0e}", largest["volumes"] <= 1e-9),
        ("" if np.isnan(off["off, rms"]) else f"{off['off, rms']:.4f}", not off["off, rms"] > (0.007 if is_fine else 0.013)),
        ("" if np.isnan(off["off, largest"]) else f"{off['off, largest']:.2f}", not off["off, largest"] > 0.3),
        (f"{median['tetrahedra']:.0f}", True),
        (f"{median['gamma, mean']:.3f}", is_cut or median["gamma, mean"] >= (0.75 if is_fine else 0.73)),
        (f"{median['1 %']:.3f}", is_cut or median["1 %"] >= (0.39 if is_fine else 0.38)),
        (f"{bad}", bad <= (0 if is_equilibrium else tetrahedra / 10_000)),
        (f"{least['least']:.3f}", least["least"] >= (0.1 if is_equilibrium else 0.02)),
        (f"{median['run, s']:.1f}", True),
        (f"{median['remeshing, s']:.1f}", median["remeshing, s"] <= SECONDS[grains, per_grain]),
        (f"{median['filling, s']:.1f}", grains < 10_000 or median["filling, s"] <= 30),
        (f"{largest['GB']:.2f}", grains < 10_000 or largest["GB"] <= 6),
    ]
    texts = [text if is_met else f"**{text}**" for text, is_met in cells]
    return "| " + " | ".join([name_of(row), *texts]) + " |"


def name_of(row):
    grains, domain, relaxation, per_grain = row
    return f"{grains} {domain} {relaxation} D/{per_grain}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("words", nargs="*")
    parser.add_argument("--seeds", type=int, default=3)
    arguments = parser.parse_args()
    print("| " + " | ".join(COLUMNS) + " |\n|" + "---|" * len(COLUMNS), flush=True)
    for row in ROWS:
        if not all(word in name_of(row).split() for word in arguments.words):
            continue
        found = []
        for seed in range(1, arguments.seeds + 1):
            with tempfile.TemporaryDirectory() as folder:
                found.append(meshed(arguments.program, row, seed, folder))
        good = [values for values in found if values]
        print(shown(row, good, len(found)) if good else f"| {name_of(row)} | **0 of {len(found)}** |", flush=True)
    for name, options in ALONE.items():
        if not all(word in name.split() for word in arguments.words):
            continue
        with tempfile.TemporaryDirectory() as folder:
            found = [alone(arguments.program, options, seed, folder) for seed in range(1, arguments.seeds + 1)]
        good = [values for values in found if values]
        print(shown_alone(name, good, len(found)) if good else f"| {name} | 0 of {len(found)} |", flush=True)


if __name__ == "__main__":
    main()
