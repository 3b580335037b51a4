// Cells of random seeds by voro++: vertices, faces, neighbours and volumes of all, one thread.
#include <cstdio>
#include <cstdlib>
#include <cmath>
#include <ctime>
#include <random>
#include <vector>
#include <voro++.hh>

int main(int argc, char** argv) {
    const int count = argc > 1 ? std::atoi(argv[1]) : 100000;
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<double> seeds(3 * count);
    for (double& coordinate : seeds) coordinate = uniform(random);

    const std::clock_t start = std::clock();
    // Five seeds a block, as the manual advises.
    const int blocks = std::max(1, int(std::cbrt(count / 5.0)));
    voro::container container(0, 1, 0, 1, 0, 1, blocks, blocks, blocks, false, false, false, 8);
    for (int i = 0; i < count; i++) container.put(i, seeds[3 * i], seeds[3 * i + 1], seeds[3 * i + 2]);
    voro::c_loop_all loop(container);
    voro::voronoicell_neighbor cell;
    std::vector<std::vector<double>> vertices(count);
    std::vector<std::vector<int>> faces(count), neighbors(count);
    std::vector<double> volumes(count);
    double volume = 0;
    if (loop.start()) do {
        if (!container.compute_cell(cell, loop)) continue;
        const int id = loop.pid();
        cell.vertices(loop.x(), loop.y(), loop.z(), vertices[id]);
        cell.face_vertices(faces[id]);
        cell.neighbors(neighbors[id]);
        volume += volumes[id] = cell.volume();
    } while (loop.inc());
    const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
    std::printf("%d cells, volume - 1 = %.1e, %.3f s of processor time\n", count, volume - 1, seconds);
}
