// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>
#include <cmath>

#include "common/process/files/folder.hpp"
#include "common/process/stop_signal.hpp"
#include "server/patient/tool/commands.hpp"

namespace eti::tool {

imaging::LoadedVolume read_volume(const std::filesystem::path& file, const std::string& series) {
    (void)progress(0.0f, "reading " + file.string());
    imaging::LoadedVolume reading = imaging::read(file, {}, series);
    if (stop_requested()) {
        throw CancelledError();
    }
    for (const std::string& text : reading.remarks) {
        remark(text);
    }
    return reading;
}

imaging::Mask read_labels(const std::filesystem::path& file) {
    const imaging::LoadedVolume reading = read_volume(file);
    imaging::Mask labels{reading.volume.geometry, {}};
    labels.value.reserve(reading.volume.value.size());
    for (const float v : reading.volume.value) {
        if (v < 0.0f || v >= static_cast<float>(label_count) || v != std::floor(v)) {
            throw imaging::VolumeError(
                fmt::format("{}: a value is {}; expected labels from 0 to {}. Remedy: use labels written by "
                            "eti-anatomy segment, or number your own as in docs/anatomy/segment.md.",
                            file.string(), v, label_count - 1));
        }
        labels.value.push_back(static_cast<std::uint8_t>(v));
    }
    return labels;
}

Result write_surfaces(const std::vector<NamedSurface>& surfaces, const std::filesystem::path& folder) {
    make_folder(folder);
    Result result;
    for (const NamedSurface& surface : surfaces) {
        const std::filesystem::path file = folder / (surface.name + ".stl");
        imaging::write_bytes(file, encode_stl(surface.mesh));
        const MeshReport& r = surface.report;
        result.text += fmt::format("{}: {} triangles in {} parts, {:.1f} ml; closed, manifold, oriented\n",
                                   file.string(), r.triangles, r.components, 1e6 * r.volume);
        result.json["surfaces"].push_back({{"name", surface.name},
                                           {"file", file.string()},
                                           {"triangles", r.triangles},
                                           {"parts", r.components},
                                           {"volume_ml", 1e6 * r.volume}});
    }
    return result;
}

}  // namespace eti::tool
