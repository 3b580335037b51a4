// Writes the .json files here: levels 1 to 3 and limit positions of meshes with features, from OpenSubdiv 3.5.0 in doubles.
//
//     g++ -std=c++17 opensubdiv.cpp -losdCPU -o opensubdiv && ./opensubdiv && rm opensubdiv
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

using namespace OpenSubdiv;

struct Point {
    double p[3];
    void Clear(void * = nullptr) { p[0] = p[1] = p[2] = 0; }
    void AddWithWeight(const Point &other, double weight) {
        for (int i = 0; i < 3; ++i) p[i] += weight * other.p[i];
    }
};

struct Crease { int a, b; float sharpness; };
struct Corner { int v; float sharpness; };

struct Case {
    std::string name;
    bool loop, corner_boundary;
    std::vector<Point> points;
    std::vector<std::vector<int>> faces;
    std::vector<Crease> creases;
    std::vector<Corner> corners;
};

static void print_points(FILE *out, const std::vector<Point> &points) {
    for (size_t i = 0; i < points.size(); ++i)
        std::fprintf(out, "%s[%.17g,%.17g,%.17g]", i ? "," : "", points[i].p[0], points[i].p[1], points[i].p[2]);
}

static void run(const Case &c) {
    std::vector<int> counts, indices, crease_ends, corner_ids;
    std::vector<float> crease_weights, corner_weights;
    for (auto &face : c.faces) {
        counts.push_back(int(face.size()));
        indices.insert(indices.end(), face.begin(), face.end());
    }
    for (auto &crease : c.creases) {
        crease_ends.insert(crease_ends.end(), {crease.a, crease.b});
        crease_weights.push_back(crease.sharpness);
    }
    for (auto &corner : c.corners) {
        corner_ids.push_back(corner.v);
        corner_weights.push_back(corner.sharpness);
    }
    Far::TopologyDescriptor descriptor;
    descriptor.numVertices = int(c.points.size());
    descriptor.numFaces = int(c.faces.size());
    descriptor.numVertsPerFace = counts.data();
    descriptor.vertIndicesPerFace = indices.data();
    descriptor.numCreases = int(c.creases.size());
    descriptor.creaseVertexIndexPairs = crease_ends.data();
    descriptor.creaseWeights = crease_weights.data();
    descriptor.numCorners = int(c.corners.size());
    descriptor.cornerVertexIndices = corner_ids.data();
    descriptor.cornerWeights = corner_weights.data();
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(c.corner_boundary ? Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER : Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    std::unique_ptr<Far::TopologyRefiner> refiner(
        Factory::Create(descriptor, Factory::Options(c.loop ? Sdc::SCHEME_LOOP : Sdc::SCHEME_CATMARK, options)));
    Far::TopologyRefiner::UniformOptions uniform(3);
    uniform.fullTopologyInLastLevel = true;
    refiner->RefineUniform(uniform);
    Far::PrimvarRefinerReal<double> primvar(*refiner);

    FILE *out = std::fopen((c.name + ".json").c_str(), "w");
    std::fprintf(out, "{\"scheme\":\"%s\",\"source\":\"OpenSubdiv 3.5.0, opensubdiv.cpp\",\"boundary\":\"%s\",\n\"vertices\":[",
                 c.loop ? "loop" : "catmull-clark", c.corner_boundary ? "edge_corner" : "edge");
    print_points(out, c.points);
    std::fprintf(out, "],\n\"faces\":[");
    for (size_t f = 0; f < c.faces.size(); ++f) {
        std::fprintf(out, "%s[", f ? "," : "");
        for (size_t i = 0; i < c.faces[f].size(); ++i) std::fprintf(out, "%s%d", i ? "," : "", c.faces[f][i]);
        std::fprintf(out, "]");
    }
    std::fprintf(out, "],\n\"creases\":[");
    for (size_t i = 0; i < c.creases.size(); ++i)
        std::fprintf(out, "%s[%d,%d,%g]", i ? "," : "", c.creases[i].a, c.creases[i].b, c.creases[i].sharpness);
    std::fprintf(out, "],\"corners\":[");
    for (size_t i = 0; i < c.corners.size(); ++i) std::fprintf(out, "%s[%d,%g]", i ? "," : "", c.corners[i].v, c.corners[i].sharpness);
    std::fprintf(out, "],\n\"levels\":[");
    std::vector<Point> coarse = c.points, fine;
    for (int l = 1; l <= 3; ++l) {
        const Far::TopologyLevel &parent = refiner->GetLevel(l - 1);
        fine.resize(refiner->GetLevel(l).GetNumVertices());
        primvar.Interpolate(l, coarse, fine);
        std::vector<std::vector<int>> parents(fine.size());
        for (int v = 0; v < parent.GetNumVertices(); ++v) parents[parent.GetVertexChildVertex(v)] = {v, v};
        for (int e = 0; e < parent.GetNumEdges(); ++e) {
            auto ends = parent.GetEdgeVertices(e);
            parents[parent.GetEdgeChildVertex(e)] = {ends[0], ends[1]};
        }
        for (int f = 0; !c.loop && f < parent.GetNumFaces(); ++f) {
            auto corners = parent.GetFaceVertices(f);
            for (int i = 0; i < corners.size(); ++i) parents[parent.GetFaceChildVertex(f)].push_back(corners[i]);
        }
        std::fprintf(out, "%s{\"level\":%d,\"vertices\":[", l > 1 ? ",\n" : "\n", l);
        print_points(out, fine);
        std::fprintf(out, "],\n\"parents\":[");
        for (size_t i = 0; i < parents.size(); ++i) {
            std::fprintf(out, "%s[", i ? "," : "");
            for (size_t j = 0; j < parents[i].size(); ++j) std::fprintf(out, "%s%d", j ? "," : "", parents[i][j]);
            std::fprintf(out, "]");
        }
        std::fprintf(out, "]}");
        coarse.swap(fine);
    }
    std::vector<Point> limits(coarse.size());
    primvar.Limit(coarse, limits);
    std::fprintf(out, "],\n\"limit_of_level_3\":[");
    print_points(out, limits);
    std::fprintf(out, "]}\n");
    std::fclose(out);
}

int main() {
    std::vector<Point> cube = {{{0, 0, 0}}, {{1, 0, 0}}, {{1, 1, 0}}, {{0, 1, 0}}, {{0, 0, 1}}, {{1.1, 0, 1}}, {{1, 1.2, 1}}, {{0, 1, 1.3}}};
    std::vector<std::vector<int>> quads = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    std::vector<std::vector<int>> triangles;
    for (auto &q : quads) {
        triangles.push_back({q[0], q[1], q[2]});
        triangles.push_back({q[0], q[2], q[3]});
    }
    // A square of 3 x 3 cells that is no plane and has a hole: boundary corners, and a vertex inside with 4 edges or 6.
    std::vector<Point> sheet;
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x) sheet.push_back({{double(x), double(y), 0.25 * ((x * x + 3 * y + x * y) % 5)}});
    std::vector<std::vector<int>> cells, halves;
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 3; ++x) {
            if (x == 1 && y == 0) continue;
            int a = 4 * y + x;
            cells.push_back({a, a + 1, a + 5, a + 4});
            halves.push_back({a, a + 1, a + 5});
            halves.push_back({a, a + 5, a + 4});
        }
    // A prism on a pentagon, the top cut into triangles around a point.
    std::vector<Point> prism;
    for (int z = 0; z < 2; ++z)
        for (int i = 0; i < 5; ++i) prism.push_back({{std::cos(1.2566370614359172 * i), std::sin(1.2566370614359172 * i), double(z)}});
    prism.push_back({{0.1, 0.05, 1.5}});
    std::vector<std::vector<int>> mixed = {{4, 3, 2, 1, 0}};
    for (int i = 0; i < 5; ++i) {
        int j = (i + 1) % 5;
        mixed.push_back({i, j, 5 + j, 5 + i});
        mixed.push_back({5 + i, 5 + j, 10});
    }
    std::vector<Crease> loop_of_edges = {{4, 5, 10}, {5, 6, 10}, {6, 7, 10}, {7, 4, 10}};
    std::vector<Crease> soft = {{4, 5, 10}, {5, 6, 2.3f}, {6, 7, 1.5f}, {0, 4, 0.7f}, {0, 1, 2}};
    std::vector<Crease> darts = {{4, 5, 10}, {5, 6, 10}, {0, 3, 10}, {1, 2, 1.25f}};
    std::vector<Corner> corners = {{2, 10}, {7, 1.4f}};
    const std::vector<Crease> rim = {{5, 6, 10}, {6, 7, 10}, {7, 8, 10}, {8, 9, 10}, {9, 5, 10}, {0, 5, 10}, {10, 7, 0.6f}};
    for (const Case &c : std::vector<Case>{
             {"catmull_clark_mixed", false, false, prism, mixed, {}, {}},
             {"catmull_clark_mixed_creases", false, false, prism, mixed, rim, {{10, 10}}},
             {"catmull_clark_cube_loop", false, false, cube, quads, loop_of_edges, corners},
             {"catmull_clark_cube_soft", false, false, cube, quads, soft, corners},
             {"catmull_clark_cube_darts", false, false, cube, quads, darts, {}},
             {"catmull_clark_open", false, false, sheet, cells, {{5, 9, 10}, {9, 10, 1.5f}}, {}},
             {"catmull_clark_open_corner", false, true, sheet, cells, {{10, 14, 10}}, {{9, 0.5f}}},
             {"loop_cube_loop", true, false, cube, triangles, loop_of_edges, corners},
             {"loop_cube_soft", true, false, cube, triangles, soft, corners},
             {"loop_cube_darts", true, false, cube, triangles, darts, {}},
             {"loop_open", true, false, sheet, halves, {{5, 9, 10}, {9, 10, 1.5f}}, {}},
             {"loop_open_corner", true, true, sheet, halves, {{10, 14, 10}}, {{9, 0.5f}}},
         })
        run(c);
}
