// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>
#include <cmath>
#include <map>
#include <set>

#include "common/process/escaped.hpp"
#include "common/process/files/folder.hpp"
#include "common/process/stop_signal.hpp"
#include "server/patient/segmentation/placement/points_file.hpp"
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

namespace {

/// The label of each value that occurs in a segmentation whose segments have names.
std::map<int, Label> labels_of_segments(const imaging::LoadedVolume& reading, const std::string& file) {
    std::map<int, Label> meant{{0, Label::outside}};
    std::set<float> seen;
    float last = 0.0f;
    for (const float v : reading.volume.value) {
        if (v != last) {
            seen.insert(v);
            last = v;
        }
    }
    for (const float v : seen) {
        if (v == 0.0f) {
            continue;
        }
        const bool whole = v > 0.0f && v < 65536.0f && v == std::floor(v);
        const auto segment = whole ? reading.segments.find(static_cast<int>(v)) : reading.segments.end();
        if (segment == reading.segments.end()) {
            throw imaging::VolumeError(
                fmt::format("{}: a value is {}, which no segment has; expected the values of its segments. "
                            "Remedy: save the segmentation again with 3D Slicer.",
                            file, v));
        }
        const auto label = label_named(segment->second);
        if (!label) {
            throw imaging::VolumeError(fmt::format(
                "{}: a segment is named '{}'; expected a name that contains skin, soft tissue, airway, bone, "
                "skull, mandible, spine, tongue or epiglottis. Remedy: rename the segment in 3D Slicer.",
                file, escaped(segment->second, max_shown_bytes)));
        }
        meant[segment->first] = *label;
    }
    return meant;
}

}  // namespace

imaging::Mask read_labels(const std::filesystem::path& file) {
    const imaging::LoadedVolume reading = read_volume(file);
    imaging::Mask labels{reading.volume.geometry, {}};
    labels.value.reserve(reading.volume.value.size());
    if (!reading.segments.empty()) {
        std::set<std::string> named;
        const std::map<int, Label> meant = labels_of_segments(reading, file.string());
        for (const float v : reading.volume.value) {
            labels.value.push_back(value_of(meant.at(static_cast<int>(v))));
        }
        for (const auto& [value, label] : meant) {
            if (value != 0) {
                named.insert(fmt::format("'{}' is {}", escaped(reading.segments.at(value), max_shown_bytes),
                                         label_names[value_of(label)]));
            }
        }
        remark(fmt::format("{}: segments by name: {}", file.string(), fmt::join(named, ", ")));
        return labels;
    }
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

Points read_landmarks(const std::filesystem::path& file) {
    std::vector<std::string> remarks;
    Points points = file.empty() ? Points{} : read_points(file, remarks);
    for (const std::string& text : remarks) {
        remark(text);
    }
    return points;
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
