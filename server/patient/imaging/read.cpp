// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/imaging/read.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "common/process/files/memfd_pipe.hpp"
#include "server/patient/imaging/formats.hpp"

namespace eti::imaging {

namespace {

/// Transfers a volume from a child process.
class Channel : public MemfdPipe {
  public:
    using MemfdPipe::get;
    using MemfdPipe::put;

    void put(const Geometry& geometry) const {
        put(geometry.size.data(), sizeof(geometry.size));
        put(geometry.origin.data(), 3 * sizeof(double));
        put(geometry.step.data(), 9 * sizeof(double));
    }
    [[nodiscard]] bool get(Geometry& geometry) const {
        return get(geometry.size.data(), sizeof(geometry.size)) &&
               get(geometry.origin.data(), 3 * sizeof(double)) &&
               get(geometry.step.data(), 9 * sizeof(double));
    }
};

enum Outcome : int { whole = 0, refused = 3 };

int parse_into(const Channel& channel, const std::filesystem::path& path, const std::string& series) {
    try {
        const LoadedVolume reading = parse(path, series);
        channel.put(reading.volume.geometry);
        channel.put(reading.volume.value.data(), reading.volume.value.size() * sizeof(float));
        const std::size_t remarks = reading.remarks.size();
        channel.put(&remarks, sizeof(remarks));
        for (const std::string& remark : reading.remarks) {
            channel.put(remark);
        }
        const std::size_t segments = reading.segments.size();
        channel.put(&segments, sizeof(segments));
        for (const auto& [value, segment] : reading.segments) {
            channel.put(&value, sizeof(value));
            channel.put(segment);
        }
        return whole;
    } catch (const std::bad_alloc&) {
        channel.put(path.string() +
                    ": reading exceeds the memory limit; expected a smaller volume. Remedy: crop it to head "
                    "and neck.");
    } catch (const std::exception& error) {
        channel.put(error.what());
    }
    return refused;
}

[[noreturn]] void broken(const std::filesystem::path& path, const std::string& how) {
    throw VolumeError(damaged_file_message(path.string(), how, "a CT volume"));
}

}  // namespace

LoadedVolume parse(const std::filesystem::path& path, const std::string& series) {
    const std::string name = path.string();
    std::error_code error;
    LoadedVolume reading;
    if (std::filesystem::is_directory(path, error)) {
        reading.volume = read_dicom(path, reading.remarks, series);
    } else {
        const Bytes data = read_bytes(path);
        if (!series.empty()) {
            throw VolumeError(fmt::format(
                "{}: is a file; expected a DICOM folder, as a series is chosen. Remedy: omit --series.",
                name));
        }
        const auto starts = [&](std::size_t at, std::string_view text) {
            return data.size() >= at + text.size() && std::equal(text.begin(), text.end(), data.begin() + at);
        };
        if (starts(0, "NRRD000")) {
            reading.volume = parse_nrrd(data, name);
            reading.segments = parse_segment_names(data, name);
        } else if (starts(128, "DICM")) {
            reading.volume = read_dicom(path, reading.remarks);
        } else if (path.extension() == ".inv3") {
            reading.volume = parse_inv3(data, name);
        } else if (name.ends_with(".nii") || name.ends_with(".nii.gz") || starts(344, "n+1")) {
            reading.volume = parse_nifti(data, name, &reading.remarks);
        } else {
            throw VolumeError(fmt::format(
                "{}: unknown format; expected NRRD (.nrrd), NIfTI (.nii, .nii.gz), DICOM (a folder) or an "
                "InVesalius project (.inv3). Remedy: export the CT as one of these.",
                name));
        }
    }
    require_valid(reading.volume.geometry, name);
    require_finite(reading.volume, name);
    return reading;
}

LoadedVolume read(const std::filesystem::path& path, const GuardLimits& limits, const std::string& series) {
    const Channel channel;
    const GuardedResult ended = run_guarded([&] { return parse_into(channel, path, series); }, limits);
    if (ended.broken) {
        broken(path, *ended.broken);
    }
    channel.rewind();
    if (ended.status != whole) {
        std::string finding;
        if (!channel.get(finding)) {
            broken(path, fmt::format("status {}", ended.status));
        }
        throw VolumeError(finding);
    }
    LoadedVolume reading;
    std::size_t remarks = 0;
    bool good = channel.get(reading.volume.geometry);
    if (good) {
        // The result of a compromised child process is validated, too.
        require_valid(reading.volume.geometry, path.string());
        reading.volume.value.resize(reading.volume.geometry.count());
        good = channel.get(reading.volume.value.data(), reading.volume.value.size() * sizeof(float)) &&
               channel.get(&remarks, sizeof(remarks)) && remarks < 1000;
    }
    for (std::size_t i = 0; good && i < remarks; ++i) {
        good = channel.get(reading.remarks.emplace_back());
    }
    std::size_t segments = 0;
    good = good && channel.get(&segments, sizeof(segments)) && segments < 1000;
    for (std::size_t i = 0; good && i < segments; ++i) {
        int value = 0;
        good = channel.get(&value, sizeof(value)) && channel.get(reading.segments[value]);
    }
    if (!good) {
        broken(path, "an incomplete volume");
    }
    require_finite(reading.volume, path.string());
    return reading;
}

Bytes run_parser(const std::function<Bytes()>& parse_it, const std::string& name, const GuardLimits& limits) {
    try {
        return parse_in_child(parse_it, name, limits);
    } catch (const ParseError& error) {
        throw VolumeError(error.what());
    }
}

Format format_of(const std::filesystem::path& file) {
    const std::string name = file.filename().string();
    if (name.ends_with(".nrrd")) {
        return Format::nrrd;
    }
    if (name.ends_with(".nii") || name.ends_with(".nii.gz")) {
        return Format::nifti;
    }
    throw VolumeError(
        fmt::format("{}: the name does not indicate the format; expected it to end in .nrrd, .nii or "
                    ".nii.gz. Remedy: rename it.",
                    file.string()));
}

namespace {

void encode_and_write(const Geometry& geometry, Scalar type, const Bytes& data,
                      const std::filesystem::path& file) {
    if (format_of(file) == Format::nrrd) {
        write_bytes(file, encode_nrrd(geometry, type, data));
        return;
    }
    const Bytes plain = encode_nifti(geometry, type, data);
    write_bytes(file, file.extension() == ".gz" ? gzip(plain) : plain);
}

}  // namespace

void write(const Volume& volume, const std::filesystem::path& file) {
    Bytes data;
    data.reserve(2 * volume.value.size());
    for (const float v : volume.value) {
        store(data, static_cast<std::int16_t>(std::lround(std::clamp(v, -32768.0f, 32767.0f))));
    }
    encode_and_write(volume.geometry, Scalar::i16, data, file);
}

void write(const Mask& labels, const std::filesystem::path& file) {
    encode_and_write(labels.geometry, Scalar::u8, labels.value, file);
}

}  // namespace eti::imaging
