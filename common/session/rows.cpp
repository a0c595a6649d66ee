// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/session/rows.hpp"

#include <fmt/format.h>

namespace eti::session {

namespace {

struct Opened {
    hdf5::Handle data_set;
    hdf5::Handle type;
    std::vector<hsize_t> extent;
};

Opened open(const hdf5::Group& root, const std::string& path) {
    if (!root.has(path)) {
        throw hdf5::Error(fmt::format("{}: this data set is missing", root.at(path)));
    }
    Opened opened;
    opened.data_set = {H5Dopen2(root.id(), path.c_str(), H5P_DEFAULT), H5Dclose};
    const hdf5::Handle space(opened.data_set ? H5Dget_space(opened.data_set.get()) : -1, H5Sclose);
    opened.type = {opened.data_set ? H5Dget_type(opened.data_set.get()) : -1, H5Tclose};
    const int rank = space ? H5Sget_simple_extent_ndims(space.get()) : -1;
    if (!opened.type || rank < 1) {
        throw hdf5::Error(fmt::format("{}: not a readable data set: {}", root.at(path), hdf5::last_error()));
    }
    opened.extent.resize(static_cast<std::size_t>(rank));
    H5Sget_simple_extent_dims(space.get(), opened.extent.data(), nullptr);
    // Bounds the memory that a damaged extent can request.
    std::size_t left = hdf5::max_read_bytes / std::max<std::size_t>(H5Tget_size(opened.type.get()), 1);
    for (const hsize_t extent : opened.extent) {
        if (extent > left) {
            throw hdf5::Error(fmt::format(
                "{}: its stated size is larger than any such data set can be: damaged", root.at(path)));
        }
        left /= std::max<hsize_t>(extent, 1);
    }
    return opened;
}

bool read(const Opened& opened, hid_t type, std::size_t first, std::size_t rows, void* values) {
    std::vector<hsize_t> start(opened.extent.size(), 0), count = opened.extent;
    start[0] = first;
    count[0] = rows;
    const hdf5::Handle file_space(H5Dget_space(opened.data_set.get()), H5Sclose);
    const hdf5::Handle memory_space(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr),
                                    H5Sclose);
    return H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(),
                               nullptr) >= 0 &&
           H5Dread(opened.data_set.get(), type, memory_space.get(), file_space.get(), H5P_DEFAULT, values) >=
               0;
}

/// Whether the chunk that begins at row `first` exists. The library reads a missing one as zeros; this
/// project's writer writes every chunk.
bool has_chunk(const Opened& opened, std::size_t first) {
    std::vector<hsize_t> offset(opened.extent.size(), 0);
    offset[0] = first;
    unsigned mask = 0;
    haddr_t address = HADDR_UNDEF;
    hsize_t size = 0;
    return H5Dget_chunk_info_by_coord(opened.data_set.get(), offset.data(), &mask, &address, &size) >= 0 &&
           address != HADDR_UNDEF;
}

std::size_t row_bytes(const Opened& opened) {
    std::size_t bytes = H5Tget_size(opened.type.get());
    for (std::size_t i = 1; i < opened.extent.size(); ++i) {
        bytes *= opened.extent[i];
    }
    return bytes;
}

std::size_t chunk_rows(const Opened& opened) {
    const hdf5::Handle creation(H5Dget_create_plist(opened.data_set.get()), H5Pclose);
    std::vector<hsize_t> chunk(opened.extent.size(), 1);
    if (!creation || H5Pget_layout(creation.get()) != H5D_CHUNKED ||
        H5Pget_chunk(creation.get(), static_cast<int>(chunk.size()), chunk.data()) < 0) {
        return 1;
    }
    return std::max<std::size_t>(chunk[0], 1);
}

/// A stated length may be damaged, too: no file of ours lacks this many consecutive chunks.
constexpr std::size_t max_missing_chunks = 20'000;

/// Stops at the first damaged chunk if `until_first` is set.
Condition condition_of(const Opened& opened, bool until_first) {
    Condition condition{
        true, opened.extent[0], hdf5::Shape(opened.extent.begin() + 1, opened.extent.end()), {}};
    const std::size_t rows = opened.extent[0], step = chunk_rows(opened);
    std::vector<std::byte> buffer(std::min(step, rows) * row_bytes(opened));
    for (std::size_t first = 0; first < rows; first += step) {
        const std::size_t count = std::min(step, rows - first);
        if (has_chunk(opened, first) && read(opened, opened.type.get(), first, count, buffer.data())) {
            continue;
        }
        if (!condition.lost.empty() && condition.lost.back().first + condition.lost.back().count == first) {
            condition.lost.back().count += count;
        } else {
            condition.lost.push_back({first, count});
        }
        if (until_first) {
            break;
        }
        if (condition.lost.back().count > max_missing_chunks * step) {
            condition.lost.back().count = rows - condition.lost.back().first;
            break;
        }
    }
    return condition;
}

void require_rows(const hdf5::Group& root, const std::string& path, const Opened& opened, hid_t type,
                  const hdf5::Shape& row_shape) {
    const hdf5::Shape found(opened.extent.begin() + 1, opened.extent.end());
    if (found != row_shape || H5Tget_class(opened.type.get()) != H5Tget_class(type) ||
        H5Tget_size(opened.type.get()) != H5Tget_size(type) || H5Tis_variable_str(opened.type.get()) > 0) {
        throw hdf5::Error(
            fmt::format("{}: its rows have another type or shape than this program records", root.at(path)));
    }
}

}  // namespace

std::size_t Condition::end() const {
    std::size_t end = stated;
    for (auto range = lost.rbegin(); range != lost.rend() && range->first + range->count == end; ++range) {
        end = range->first;
    }
    return end;
}

std::size_t readable_rows(const hdf5::Group& root, const std::string& path) {
    return condition_of(open(root, path), true).prefix();
}

RowsEnd rows_end(const hdf5::Group& root, const std::string& path) {
    const Opened opened = open(root, path);
    const std::size_t stated = opened.extent[0], step = chunk_rows(opened);
    const hdf5::Shape row_shape(opened.extent.begin() + 1, opened.extent.end());
    std::vector<std::byte> buffer(std::min(step, stated) * row_bytes(opened));
    // A kill damages at most the last chunk and the one before it.
    constexpr std::size_t most_spoilt = 2;
    std::size_t end = stated;
    for (std::size_t i = 0; i <= most_spoilt && end > 0; ++i) {
        const std::size_t first = (end - 1) / step * step;
        if (has_chunk(opened, first) && read(opened, opened.type.get(), first, end - first, buffer.data())) {
            return {end, row_shape};
        }
        end = first;
    }
    return {end == 0 ? 0 : stated, row_shape};
}

Condition examine(const hdf5::Group& root, const std::string& path) {
    try {
        return condition_of(open(root, path), false);
    } catch (const hdf5::Error&) {
        return {};
    }
}

std::vector<std::byte> salvage(const hdf5::Group& root, const std::string& path, hid_t type,
                               const hdf5::Shape& row_shape, std::size_t rows, const Condition& condition,
                               std::span<const std::byte> fill) {
    const std::size_t bytes = fill.size();
    std::vector<std::byte> image(rows * bytes);
    const auto fill_rows = [&](std::size_t first, std::size_t past) {
        for (std::size_t row = first; row < past; ++row) {
            std::ranges::copy(fill, image.begin() + static_cast<std::ptrdiff_t>(row * bytes));
        }
    };
    if (!condition.there) {
        fill_rows(0, rows);
        return image;
    }
    const Opened opened = open(root, path);
    require_rows(root, path, opened, type, row_shape);
    std::size_t done = 0;
    const auto read_to = [&](std::size_t past) {
        past = std::min(past, rows);
        if (past > done && !read(opened, type, done, past - done, image.data() + done * bytes)) {
            fill_rows(done, past);
        }
        done = std::max(done, past);
    };
    for (const RowRange& range : condition.lost) {
        read_to(range.first);
        const std::size_t past = std::min(range.first + range.count, rows);
        fill_rows(std::min(range.first, rows), past);
        done = std::max(done, past);
    }
    read_to(condition.stated);
    fill_rows(done, rows);
    return image;
}

std::vector<std::byte> read_rows_as(const hdf5::Group& root, const std::string& path, hid_t type,
                                    const hdf5::Shape& row_shape, std::size_t rows) {
    const Opened opened = open(root, path);
    require_rows(root, path, opened, type, row_shape);
    std::vector<std::byte> bytes(rows * row_bytes(opened));
    if (rows > 0 && !read(opened, type, 0, rows, bytes.data())) {
        throw hdf5::Error(
            fmt::format("{}: the values cannot be read: {}", root.at(path), hdf5::last_error()));
    }
    return bytes;
}

std::vector<double> read_as_doubles(const hdf5::Group& root, const std::string& path, std::size_t rows) {
    const Opened opened = open(root, path);
    const H5T_class_t kind = H5Tget_class(opened.type.get());
    if (kind != H5T_FLOAT && kind != H5T_INTEGER) {
        throw hdf5::Error(fmt::format("{}: holds no numbers", root.at(path)));
    }
    std::vector<double> values(rows * (row_bytes(opened) / H5Tget_size(opened.type.get())));
    if (!values.empty() && !read(opened, H5T_NATIVE_DOUBLE, 0, rows, values.data())) {
        throw hdf5::Error(
            fmt::format("{}: the values cannot be read: {}", root.at(path), hdf5::last_error()));
    }
    return values;
}

std::string text_of(const hdf5::Group& root, const std::string& path, const char* attribute_name) {
    // Attributes are read through a group; this data set has them too.
    const hdf5::Handle data_set(H5Oopen(root.id(), path.c_str(), H5P_DEFAULT), H5Oclose);
    const hdf5::Handle attribute(data_set ? H5Aopen(data_set.get(), attribute_name, H5P_DEFAULT) : -1,
                                 H5Aclose);
    const hdf5::Handle type(attribute ? H5Aget_type(attribute.get()) : -1, H5Tclose);
    char* value = nullptr;
    if (!type || H5Tis_variable_str(type.get()) <= 0 || H5Aread(attribute.get(), type.get(), &value) < 0 ||
        value == nullptr) {
        return {};
    }
    std::string text(value);
    H5free_memory(value);
    return text;
}

bool set_rows(hid_t data_set, const hdf5::Shape& row_shape, std::size_t rows) {
    std::vector<hsize_t> extent{rows};
    extent.insert(extent.end(), row_shape.begin(), row_shape.end());
    return H5Dset_extent(data_set, extent.data()) >= 0;
}

std::optional<std::string> write_rows(hid_t data_set, hid_t type, const hdf5::Shape& row_shape,
                                      std::size_t first, std::size_t rows, const void* values) {
    std::vector<hsize_t> start{first}, count{rows};
    for (const std::size_t extent : row_shape) {
        start.push_back(0);
        count.push_back(extent);
    }
    const hdf5::Handle file_space(H5Dget_space(data_set), H5Sclose);
    const hdf5::Handle memory_space(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr),
                                    H5Sclose);
    if (H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) <
            0 ||
        H5Dwrite(data_set, type, memory_space.get(), file_space.get(), H5P_DEFAULT, values) < 0) {
        return hdf5::last_error();  // closing the spaces would clear it
    }
    return std::nullopt;
}

}  // namespace eti::session
