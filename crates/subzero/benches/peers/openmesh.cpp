// OpenMesh: Loop to level 4 from scratch, and edits of 20 000 edges of the 320 000 triangles of level 2.
#include "peer.h"
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/config.h>
#include <OpenMesh/Tools/Subdivider/Uniform/LoopT.hh>

struct Traits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
};
using TriMesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;

static TriMesh build(const Mesh &mesh) {
    TriMesh built;
    std::vector<TriMesh::VertexHandle> vertices;
    for (auto &p : mesh.points) vertices.push_back(built.add_vertex({p[0], p[1], p[2]}));
    for (auto &t : mesh.triangles) built.add_face(vertices[t[0]], vertices[t[1]], vertices[t[2]]);
    return built;
}

static void subdivide(TriMesh &mesh, int levels) {
    OpenMesh::Subdivider::Uniform::LoopT<TriMesh, double> loop;
    loop.attach(mesh);
    loop(levels);
    loop.detach();
}

int main(int argc, char **argv) {
    if (argc != 2) return std::fprintf(stderr, "usage: openmesh MESH.off\n"), 1;
    Mesh mesh = read_off(argv[1]);
    double scratch = median(3, [&] {
        TriMesh built;
        return seconds([&] {
            built = build(mesh);
            subdivide(built, 4);
        });
    });
    std::printf("OpenMesh %d.%d from scratch: %.1f million triangles/s (1 thread)\n", OM_GET_VER, OM_GET_MAJ, double(mesh.triangles.size()) * 256 / scratch * 1e-6);

    TriMesh fine = build(mesh);
    subdivide(fine, 2);
    fine.request_vertex_status();
    fine.request_edge_status();
    fine.request_halfedge_status();
    fine.request_face_status();
    const size_t edits = 20000, step = fine.n_edges() / edits;
    auto bench = [&](const char *name, auto edit) {
        double time = median(9, [&] {
            TriMesh copy = fine;
            return seconds([&] {
                for (size_t i = 0; i < edits; ++i) edit(copy, copy.edge_handle(unsigned(i * step)));
            });
        });
        std::printf("OpenMesh %s: %.0f ns an edit\n", name, time / edits * 1e9);
    };
    bench("flip", [](TriMesh &m, TriMesh::EdgeHandle e) { if (m.is_flip_ok(e)) m.flip(e); });
    bench("split", [](TriMesh &m, TriMesh::EdgeHandle e) { m.split(e, m.add_vertex(m.calc_edge_midpoint(e))); });
    bench("collapse", [](TriMesh &m, TriMesh::EdgeHandle e) {
        auto h = m.halfedge_handle(e, 0);
        if (!m.status(e).deleted() && m.is_collapse_ok(h)) m.collapse(h);
    });
}
