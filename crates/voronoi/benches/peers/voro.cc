// Cells of random seeds by voro++: vertices, faces, neighbours and volumes of all, one thread. With a second argument, cells come one
// after another, and only their volumes and neighbours are asked for.
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
    const bool stream = argc > 2;
    const int kept = stream ? 0 : count;
    std::vector<std::vector<double>> vertices(kept);
    std::vector<std::vector<int>> faces(kept), neighbors(kept);
    std::vector<double> volumes(kept);
    std::vector<int> beyond;
    double volume = 0;
    if (loop.start()) do {
        if (!container.compute_cell(cell, loop)) continue;
        if (stream) {
            cell.neighbors(beyond);
            volume += cell.volume();
            continue;
        }
        const int id = loop.pid();
        cell.vertices(loop.x(), loop.y(), loop.z(), vertices[id]);
        cell.face_vertices(faces[id]);
        cell.neighbors(neighbors[id]);
        volume += volumes[id] = cell.volume();
    } while (loop.inc());
    const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
    std::printf("%d cells, volume - 1 = %.1e, %.3f s of processor time\n", count, volume - 1, seconds);
}
