// CGAL: Loop to level 4 from scratch, on a Surface_mesh.
#include "peer.h"
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/subdivision_method_3.h>
#include <CGAL/version.h>

using Kernel = CGAL::Simple_cartesian<double>;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

int main(int argc, char **argv) {
    if (argc != 2) return std::fprintf(stderr, "usage: cgal MESH.off\n"), 1;
    Mesh mesh = read_off(argv[1]);
    double scratch = median(5, [&] {
        SurfaceMesh surface;
        return seconds([&] {
            for (auto &p : mesh.points) surface.add_vertex(Kernel::Point_3(p[0], p[1], p[2]));
            for (auto &t : mesh.triangles)
                surface.add_face(SurfaceMesh::Vertex_index(t[0]), SurfaceMesh::Vertex_index(t[1]), SurfaceMesh::Vertex_index(t[2]));
            CGAL::Subdivision_method_3::Loop_subdivision(surface, CGAL::parameters::number_of_iterations(4));
        });
    });
    std::printf("CGAL %s from scratch: %.1f million triangles/s (1 thread)\n", CGAL_VERSION_STR, double(mesh.triangles.size()) * 256 / scratch * 1e-6);
}
