// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// A surface, by each file name extension that selects a format.
#include "common/mesh/triangle_mesh.hpp"
#include "reader.hpp"
#include "server/patient/imaging/mesh_file.hpp"
#include "server/patient/imaging/volume.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eti;
    for (const char* name : {"fuzzed.stl", "fuzzed.obj", "fuzzed.ply"}) {
        fuzz::read_or_refuse<imaging::VolumeError>(name, [&] {
            const TriangleMesh mesh = imaging::parse_mesh({data, size}, name);
            for (const auto& triangle : mesh.triangles) {
                for (const std::uint32_t corner : triangle) {
                    fuzz::require(corner < mesh.vertices.size(), "a corner without a vertex");
                }
            }
            for (const Vec3f& vertex : mesh.vertices) {
                fuzz::require(vertex.allFinite(), "a vertex that is nowhere");
            }
        });
    }
    return 0;
}
