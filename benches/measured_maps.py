"""Grains of whole measured maps beside those that others find.

    python3 benches/measured_maps.py PROGRAM FOLDER

FOLDER holds maps that this project cannot carry: twins.ctf and the 59 sections of 3dData, as ang_stack, from the MTEX toolbox (GPL-2.0), and Small_IN100_Slice1.dream3d, a test file
of DREAM.3D. Numbers are those of MTEX's documentation (twins at 5 degrees), or of a program in NumPy that was written for these data alone.
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

# Options; grains; then grains of so many points or more, or the points of the largest.
MASK = "--min-ci 0.1 --min-iq 120"
ROWS = [
    ("twins.ctf", "--threshold 2", 149, {3: 94}, []),
    ("twins.ctf", "--threshold 5", 126, {3: 92}, []),
    ("twins.ctf", "--threshold 10", 125, {3: 91}, []),
    ("twins.ctf", "--threshold 15", 121, {3: 87}, []),
    ("Small_IN100_Slice1.dream3d", f"--threshold 5 {MASK}", 346, {3: 239, 16: 186}, [801, 721, 669, 589, 520, 514]),
    ("Small_IN100_Slice1.dream3d", f"--threshold 10 {MASK}", 329, {3: 230, 16: 177}, [801, 721, 669, 589, 520, 514]),
    ("Small_IN100_Slice1.dream3d", f"--threshold 15 {MASK}", 318, {3: 221, 16: 170}, [801, 721, 671, 589, 542, 520]),
]
# All sections, where points of confidence 0 count as without a solution: grains before small ones are dropped. Single points cannot all stay open in space.
SECTIONS = [(5, 1522), (10, 955), (15, 753)]
# Small grains dropped and filled: what is left, and the points of the largest.
CLEANED = [
    ("twins.ctf", "--threshold 5 --min-voxels 3", 92, [2016, 1801, 1644, 1448, 1288, 967, 955, 940, 936, 811]),
    ("sections", "--threshold 10 --min-ci 0.001 --min-voxels 16", 102, [20910, 13930, 11495, 8144, 3001, 2652, 2519, 1329, 1211, 1184]),
]


def counts(program, path, options, folder):
    """Points of the grains, the largest first."""
    table = folder / "grains.json"
    words = [program, "smooth", str(path), *options.split(), "--decimate", "0", "-q"]
    subprocess.run([*words, "-o", str(folder / "clean.npy"), "--stats", str(table)], check=True)
    return sorted((grain["VoxelCount"] for grain in json.loads(table.read_text())["grains"]), reverse=True)


def main(program, maps):
    program, maps = str(pathlib.Path(program).resolve()), pathlib.Path(maps).resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        # The first section is bad, and the last is shifted.
        (folder / "sections").mkdir()
        for section in range(1, 58):
            (folder / "sections" / f"S{section:02}.ang").symlink_to(maps / "ang_stack" / f"S{section:02}.ANG")
        failed = False
        for file, options, grains, at_least, largest in ROWS:
            # Points without a solution stay open, so that no grain gets any.
            found = counts(program, maps / file, f"{options} --min-pore 1", folder)
            of = {least: sum(count >= least for count in found) for least in at_least}
            good = (len(found), of, found[: len(largest)]) == (grains, at_least, largest)
            failed |= not good
            print("good " if good else "FAILS", file, options, len(found), of, found[: len(largest)])
        for threshold, grains in SECTIONS:
            words = [program, "smooth", str(maps / "ang_stack"), "--threshold", str(threshold), "--min-ci", "0.001", "--min-voxels", "64"]
            said = subprocess.run([*words, "-o", str(folder / "clean.npy")], check=True, capture_output=True, text=True).stderr
            found = int(re.search(r" in (\d+) grains", said)[1])
            failed |= found != grains
            print("good " if found == grains else "FAILS", "ang_stack", threshold, found)
        for file, options, grains, largest in CLEANED:
            found = counts(program, (folder if file == "sections" else maps) / file, options, folder)
            good = (len(found), found[: len(largest)]) == (grains, largest)
            failed |= not good
            print("good " if good else "FAILS", file, options, len(found), found[: len(largest)])
    return failed


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
