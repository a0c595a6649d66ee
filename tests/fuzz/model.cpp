// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// A patient's model, edited inside HDF5 as in hdf5_edits.hpp. An accepted model must satisfy what a server
// relies on.
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "hdf5_edits.hpp"
#include "server/patient/model/model_file.hpp"
#include "tests/unit/server/patient/model/random_patient.hpp"

namespace eti::patient {
namespace {

std::vector<char> saved() {
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("fuzz-" + std::to_string(::getpid()) + ".patient.model");
    save_patient(test::random_patient(20, 5, 3), path, {{"generator", "fuzz"}});
    std::ifstream in(path, std::ios::binary);
    std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
    std::filesystem::remove(path);
    return bytes;
}

void require_usable(const Patient& patient) {
    const std::size_t particles = patient.particles.size();
    fuzz::require(
        patient.particles.mass.size() == particles && patient.particles.radius.size() == particles &&
            patient.particles.tissue.size() == particles && patient.particles.bones.size() == particles,
        "particles of unequal arrays");
    for (const std::uint32_t member : patient.clusters.member) {
        fuzz::require(member < particles, "a cluster of a particle that is none");
    }
    for (const auto& corners : patient.tetrahedra.corners) {
        for (const std::uint32_t corner : corners) {
            fuzz::require(corner < particles, "a tetrahedron of a particle that is none");
        }
    }
    for (const Surface& surface : patient.surfaces) {
        fuzz::require(surface.skin.size() == surface.mesh.vertices.size(), "vertices without skin weights");
        for (const SkinWeights& skin : surface.skin) {
            for (const std::uint16_t frame : skin.frame) {
                fuzz::require(frame < patient.frame_rest_centre.size(), "a vertex of a frame that is none");
            }
        }
    }
}

}  // namespace
}  // namespace eti::patient

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eti;
    hdf5::prepare_thread();
    static const std::vector<char> sound = patient::saved();
    static const fuzz::MemoryFile file;
    const std::filesystem::path path = file.path();
    fuzz::hold_changed(file, sound, data, size);
    fuzz::read_or_refuse<hdf5::Error>(path.string(),
                                      [&] { patient::require_usable(patient::load_patient(path)); });
    fuzz::read_or_refuse<hdf5::Error>(path.string(), [&] { (void)patient::load_provenance(path); });
    return 0;
}
