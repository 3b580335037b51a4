// CGAL: Loop to level 4, Catmull-Clark and Doo-Sabin to level 3, from scratch, on a Surface_mesh.
#include "peer.h"
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/subdivision_method_3.h>
#include <CGAL/version.h>

using Kernel = CGAL::Simple_cartesian<double>;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

template <class Scheme> void run(const Mesh &mesh, const char *name, Scheme scheme) {
    size_t faces = 0;
    double scratch = median(5, [&] {
        SurfaceMesh surface;
        double time = seconds([&] {
            for (auto &p : mesh.points) surface.add_vertex(Kernel::Point_3(p[0], p[1], p[2]));
            for (auto &t : mesh.triangles)
                surface.add_face(SurfaceMesh::Vertex_index(t[0]), SurfaceMesh::Vertex_index(t[1]), SurfaceMesh::Vertex_index(t[2]));
            scheme(surface);
        });
        faces = surface.number_of_faces();
        return time;
    });
    std::printf("CGAL %s %s from scratch: %.1f million faces/s (1 thread)\n", CGAL_VERSION_STR, name, double(faces) / scratch * 1e-6);
}

int main(int argc, char **argv) {
    if (argc != 2) return std::fprintf(stderr, "usage: cgal MESH.off\n"), 1;
    Mesh mesh = read_off(argv[1]);
    using namespace CGAL::Subdivision_method_3;
    using CGAL::parameters::number_of_iterations;
    run(mesh, "Loop", [](SurfaceMesh &surface) { Loop_subdivision(surface, number_of_iterations(4)); });
    run(mesh, "Catmull-Clark", [](SurfaceMesh &surface) { CatmullClark_subdivision(surface, number_of_iterations(3)); });
    run(mesh, "Doo-Sabin", [](SurfaceMesh &surface) { DooSabin_subdivision(surface, number_of_iterations(3)); });
}
