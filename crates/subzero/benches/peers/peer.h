// What the peers' programs share: reading the mesh, and medians of times.
#pragma once
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

struct Mesh {
    std::vector<std::array<double, 3>> points;
    std::vector<std::array<int, 3>> triangles;
};

inline Mesh read_off(const char *path) {
    std::ifstream in(path);
    std::string magic;
    size_t points = 0, triangles = 0, edges = 0;
    in >> magic >> points >> triangles >> edges;
    Mesh mesh{std::vector<std::array<double, 3>>(points), std::vector<std::array<int, 3>>(triangles)};
    for (auto &p : mesh.points) in >> p[0] >> p[1] >> p[2];
    int corners;
    for (auto &t : mesh.triangles) in >> corners >> t[0] >> t[1] >> t[2];
    if (!in || magic != "OFF") { std::fprintf(stderr, "%s is no OFF file of triangles\n", path); std::exit(1); }
    return mesh;
}

// The median time of some runs in seconds; `run` returns the seconds that count.
template <class Run> double median(int runs, Run run) {
    std::vector<double> times;
    for (int i = 0; i < runs; ++i) times.push_back(run());
    std::sort(times.begin(), times.end());
    return times[times.size() / 2];
}

template <class Work> double seconds(Work work) {
    auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}
