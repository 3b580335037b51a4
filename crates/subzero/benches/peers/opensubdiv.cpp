// OpenSubdiv: Loop to level 4 and Catmull-Clark to level 3 from scratch, and new points for Loop through one table of composed stencils.
#include "peer.h"
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/version.h>
#include <memory>
#include <thread>

using namespace OpenSubdiv;

struct Point {
    double p[3];
    void Clear(void * = nullptr) { p[0] = p[1] = p[2] = 0; }
    void AddWithWeight(const Point &other, double weight) {
        for (int i = 0; i < 3; ++i) p[i] += weight * other.p[i];
    }
};

static Far::TopologyRefiner *refined(const Mesh &mesh, Sdc::SchemeType scheme, int levels) {
    static std::vector<int> corners;
    corners.assign(mesh.triangles.size(), 3);
    Far::TopologyDescriptor descriptor;
    descriptor.numVertices = int(mesh.points.size());
    descriptor.numFaces = int(mesh.triangles.size());
    descriptor.numVertsPerFace = corners.data();
    descriptor.vertIndicesPerFace = mesh.triangles[0].data();
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
    auto *refiner = Factory::Create(descriptor, Factory::Options(scheme, options));
    Far::TopologyRefiner::UniformOptions uniform(levels);
    // The leanest: the last level without the relations that only a further one needs.
    uniform.fullTopologyInLastLevel = false;
    refiner->RefineUniform(uniform);
    return refiner;
}

static void from_scratch(const Mesh &mesh, const std::vector<Point> &base, Sdc::SchemeType scheme, const char *name, int levels) {
    size_t faces = 0;
    double scratch = median(7, [&] {
        std::unique_ptr<Far::TopologyRefiner> refiner;
        std::vector<Point> coarse, fine;
        double time = seconds([&] {
            refiner.reset(refined(mesh, scheme, levels));
            Far::PrimvarRefinerReal<double> primvar(*refiner);
            coarse = base;
            for (int level = 1; level <= levels; ++level) {
                fine.resize(refiner->GetLevel(level).GetNumVertices());
                primvar.Interpolate(level, coarse, fine);
                coarse.swap(fine);
            }
        });
        faces = refiner->GetLevel(levels).GetNumFaces();
        return time;
    });
    std::printf("OpenSubdiv %d.%d.%d %s from scratch: %.1f million faces/s (1 thread)\n", OPENSUBDIV_VERSION_MAJOR,
                OPENSUBDIV_VERSION_MINOR, OPENSUBDIV_VERSION_PATCH, name, double(faces) / scratch * 1e-6);
}

int main(int argc, char **argv) {
    if (argc != 2) return std::fprintf(stderr, "usage: opensubdiv MESH.off\n"), 1;
    const int levels = 4;
    Mesh mesh = read_off(argv[1]);
    std::vector<Point> base(mesh.points.size());
    for (size_t i = 0; i < base.size(); ++i) std::copy_n(mesh.points[i].data(), 3, base[i].p);
    from_scratch(mesh, base, Sdc::SCHEME_LOOP, "Loop", levels);
    from_scratch(mesh, base, Sdc::SCHEME_CATMARK, "Catmull-Clark", 3);

    std::unique_ptr<Far::TopologyRefiner> refiner(refined(mesh, Sdc::SCHEME_LOOP, levels));
    Far::StencilTableFactoryReal<double>::Options options;
    options.generateIntermediateLevels = false;
    options.generateOffsets = true;
    std::unique_ptr<const Far::StencilTableReal<double>> table(
        Far::StencilTableFactoryReal<double>::Create(*refiner, options));
    int count = table->GetNumStencils();
    std::vector<Point> fine(count);
    for (int threads : {1, 2}) {
        double apply = median(15, [&] {
            return seconds([&] {
                std::vector<std::thread> others;
                for (int t = 1; t < threads; ++t)
                    others.emplace_back([&, t] { table->UpdateValues(base, fine, count / threads * t, t + 1 < threads ? count / threads * (t + 1) : count); });
                table->UpdateValues(base, fine, 0, count / threads);
                for (auto &other : others) other.join();
            });
        });
        std::printf("OpenSubdiv new points: %.1f ns a point (%d threads)\n", apply / count * 1e9, threads);
    }
}
