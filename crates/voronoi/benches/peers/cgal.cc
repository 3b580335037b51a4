// The dual of a Delaunay triangulation by CGAL: circumcentres, the rings of cells around edges (the faces), and volumes of the
// finite cells, one thread. Walls are left out, which the others have to deal with.
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_with_circumcenter_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <utility>
#include <vector>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<int, Kernel>;
using CellBase = CGAL::Delaunay_triangulation_cell_base_with_circumcenter_3<Kernel>;
using Delaunay = CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<VertexBase, CellBase>>;
using Point = Kernel::Point_3;

int main(int argc, char** argv) {
    const int count = argc > 1 ? std::atoi(argv[1]) : 100000;
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<std::pair<Point, int>> seeds;
    for (int i = 0; i < count; i++) {
        const double x = uniform(random), y = uniform(random), z = uniform(random);
        seeds.emplace_back(Point(x, y, z), i);
    }

    const std::clock_t start = std::clock();
    Delaunay delaunay(seeds.begin(), seeds.end());
    std::vector<Point> corners;
    std::vector<std::size_t> starts{0};
    std::vector<std::pair<int, int>> sides;
    std::vector<double> volumes(count);
    for (const auto& edge : delaunay.finite_edges()) {
        const auto first = edge.first->vertex(edge.second), second = edge.first->vertex(edge.third);
        const std::size_t begin = corners.size();
        bool is_finite = true;
        auto around = delaunay.incident_cells(edge), stop = around;
        do {
            is_finite = is_finite && !delaunay.is_infinite(around);
            if (is_finite) corners.push_back(around->circumcenter());
        } while (++around != stop);
        if (!is_finite) {
            corners.resize(begin);
            continue;
        }
        double doubled = 0;
        for (std::size_t k = begin + 1; k + 1 < corners.size(); k++)
            doubled += 6 * std::abs(CGAL::volume(first->point(), corners[begin], corners[k], corners[k + 1]));
        volumes[first->info()] += doubled / 6;
        volumes[second->info()] += doubled / 6;
        sides.emplace_back(first->info(), second->info());
        starts.push_back(corners.size());
    }
    const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
    std::printf("%d seeds, %zu faces, %.3f s of processor time\n", count, sides.size(), seconds);
}
