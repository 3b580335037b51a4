"""Draws the pictures of subdivision.md: schemes by pyvista, from meshes that the program makes, and the rest by the program itself.

    cargo build --release && xvfb-run python3 docs/subdivision_pictures.py target/release/grainsmooth

Needs pyvista; with `ours` behind the program, it draws those of the program alone, and needs nothing.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

DOCS = Path(__file__).parent
PROGRAM = Path(sys.argv[1] if len(sys.argv) > 1 else "target/release/grainsmooth").resolve()
PANEL = 320

# A block with a step in it: squares, counter-clockwise from outside.
CUBES = {(0, 0, 0), (1, 0, 0), (0, 0, 1)}
SIDES = {
    (-1, 0, 0): [(0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)],
    (1, 0, 0): [(1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)],
    (0, -1, 0): [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)],
    (0, 1, 0): [(0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0)],
    (0, 0, -1): [(0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)],
    (0, 0, 1): [(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
}
BEZIER = "3 3\n" + "\n".join(
    f"{u} {v} {z}" for u, row in enumerate([(0, 1, 1, 0), (2, 0, 3, 1), (0, 3, 0, 2), (0, 1, 1, 0)]) for v, z in enumerate(row)
)


def block(path, triangles):
    """Writes the block as OBJ, its squares cut into triangles if so asked."""
    points, faces = {}, []
    for cube in sorted(CUBES):
        for side, square in SIDES.items():
            if tuple(c + s for c, s in zip(cube, side)) in CUBES:
                continue
            a, b, c, d = (points.setdefault(tuple(o + p for o, p in zip(cube, corner)), len(points) + 1) for corner in square)
            faces += [(a, b, c), (a, c, d)] if triangles else [(a, b, c, d)]
    lines = ["v {} {} {}".format(*point) for point in points] + ["f " + " ".join(map(str, face)) for face in faces]
    path.write_text("\n".join(lines) + "\n")
    return list(points)


def mesh(*arguments):
    subprocess.run([PROGRAM, "mesh", *map(str, arguments), "-q"], check=True)


def draw(name, panels):
    """One panel for each (title, file, whether to draw edges)."""
    import pyvista

    plotter = pyvista.Plotter(shape=(1, len(panels)), off_screen=True, border=False, window_size=(PANEL * len(panels), PANEL))
    for column, (title, path, edges) in enumerate(panels):
        plotter.subplot(0, column)
        surface = pyvista.read(path)
        plotter.add_mesh(
            surface, color="#d9c8a9", show_edges=edges, edge_color="#4a4a4a", line_width=1.2, smooth_shading=not edges, split_sharp_edges=not edges
        )
        plotter.add_text(title, font_size=9, color="black", position="lower_edge")
        plotter.camera_position = [(4.2, -5.0, 4.0), (0.8, 0.5, 0.8), (0, 0, 1)] if "bezier" not in name else "iso"
        if "bezier" in name:
            plotter.camera.zoom(0.85)
    plotter.background_color = "white"
    plotter.screenshot(DOCS / f"subdivision_{name}.png")
    plotter.close()


def levels(name, subcommand, source, directory, *options):
    out = directory / f"{name}.vtp"
    mesh(subcommand, source, "-n", 3, "--each-level", "-o", out, *options)
    return [(f"level {level}", directory / f"{name}_{level}.vtp", True) for level in range(4)]


def ours(directory):
    """The pictures that the program draws itself, of files in data/."""
    data = DOCS.parent / "data"

    def show(name, *arguments, size=(320, 240), out="out.vtp"):
        mesh(*arguments, "-o", directory / out, "--picture", DOCS / f"subdivision_{name}.png", "--picture-size", *size)

    show("teapot", "bezier", data / "teapot.bpt", "--merge", "--samples", 17, "--shading", "smooth", size=(640, 480))
    show("casteljau", "bezier", data / "plane_curve.txt", "--construction", "--t", 0.4, size=(480, 360))
    for shading in ["flat", "smooth"]:
        show(shading, "catmull-clark", data / "torus.obj", "-n", 1, "--shading", shading, size=(400, 300))
    for level in [0, 1, 2, 4]:
        show(f"curve_{level}", "b-spline", data / "outline.obj", "-n", level, size=(240, 180))
    show("four_point", "four-point", data / "outline.obj", "-n", 4, "--corners", 4, "--each-level", size=(480, 240))
    for name in ["cube", "torus"]:
        for cut, edits in [("plain", ["triangulate"]), ("presplit", ["triangulate", "split=flat"])]:
            control = f"{name}_{cut}.obj"
            show(f"{name}_{cut}", "edit", data / f"{name}.obj", *edits, out=control)
            levels = 3 if name == "cube" else 2
            show(f"{name}_{cut}_{levels}", "loop", directory / control, "-n", levels)


def main():
    with tempfile.TemporaryDirectory() as name:
        ours(Path(name))
    if "ours" in sys.argv[2:]:
        return
    with tempfile.TemporaryDirectory() as name:
        directory = Path(name)
        triangles, squares = directory / "triangles.obj", directory / "squares.obj"
        points = block(triangles, True)
        block(squares, False)

        draw("loop", levels("loop", "loop", triangles, directory))
        # The rim of the upper step, as creases of three kinds.
        rim = [points.index(p) for p in [(0, 0, 2), (1, 0, 2), (1, 1, 2), (0, 1, 2)]]
        edges = [f"{a}-{b}" for a, b in zip(rim, rim[1:] + rim[:1])]
        panels = []
        for title, options in [
            ("no crease", []),
            ("sharpness 1", ["--crease", ",".join(f"{edge}:1" for edge in edges)]),
            ("sharpness 2", ["--crease", ",".join(f"{edge}:2" for edge in edges)]),
            ("infinite", ["--crease", ",".join(edges)]),
        ]:
            path = directory / f"{title.replace(' ', '_')}.vtp"
            mesh("loop", triangles, "-n", 4, "-o", path, *options)
            panels.append((title, path, False))
        draw("creases", panels)

        panels = []
        for title in ["midpoint", "butterfly", "modified-butterfly", "loop"]:
            path = directory / f"{title}_end.vtp"
            mesh(title, triangles, "-n", 3, "-o", path)
            panels.append((title, path, True))
        draw("triangle_schemes", panels)

        draw("doo_sabin", levels("doo_sabin", "doo-sabin", squares, directory))
        draw("catmull_clark", levels("catmull_clark", "catmull-clark", squares, directory))

        patch = directory / "patch.txt"
        patch.write_text(BEZIER)
        panels = []
        for samples in [4, 10, 33]:
            path = directory / f"bezier_{samples}.vtp"
            mesh("bezier", patch, "--samples", samples, "-o", path)
            panels.append((f"{samples} x {samples} samples", path, True))
        draw("bezier", panels)


main()
