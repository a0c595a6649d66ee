// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/hdf5/copy.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cstring>
#include <map>
#include <vector>

namespace eti::hdf5 {

namespace {

class Copier {
  public:
    Copier(const Group& from, const Group& to, const CopyRules& rules)
        : from_(from), to_(to), rules_(rules) {}

    void copy_group(const std::string& path) {
        const Group source_below = path.empty() ? Group() : from_.open(path);
        const Group target_below = path.empty() ? Group() : to_.open(path);
        const Group& source = path.empty() ? from_ : source_below;
        const Group& target = path.empty() ? to_ : target_below;
        for (const std::string& name : source.attributes()) {
            copy_attribute(source.id(), target.id(), name, below(path, name));
        }
        for (const std::string& name : source.members()) {
            const std::string member = below(path, name);
            if (!rules_.keep(member)) {
                continue;
            }
            if (source.is_group(name)) {
                make_group(member);
                copy_group(member);
            } else {
                copy_data_set(member);
            }
        }
    }

  private:
    static std::string below(const std::string& path, const std::string& name) {
        return path.empty() ? name : path + "/" + name;
    }

    [[noreturn]] void fail(const std::string& path, const char* what) const {
        throw Error(fmt::format("{}: {}: {}", from_.at(path), what, last_error()));
    }

    void make_group(const std::string& path) {
        const Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
        H5Pset_obj_track_times(creation.get(), false);
        const Handle group(H5Gcreate2(to_.id(), path.c_str(), H5P_DEFAULT, creation.get(), H5P_DEFAULT),
                           H5Gclose);
        if (!group) {
            fail(path, "cannot create the group in the copy");
        }
    }

    void copy_attribute(hid_t from, hid_t to, const std::string& name, const std::string& path) {
        if (!rules_.keep(path)) {
            return;
        }
        const Handle attribute(H5Aopen(from, name.c_str(), H5P_DEFAULT), H5Aclose);
        const Handle type(attribute ? H5Aget_type(attribute.get()) : -1, H5Tclose);
        const Handle space(attribute ? H5Aget_space(attribute.get()) : -1, H5Sclose);
        if (!type || !space) {
            fail(path, "the attribute cannot be read");
        }
        const Handle copy(H5Acreate2(to, name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT),
                          H5Aclose);
        bool done = false;
        if (H5Tis_variable_str(type.get()) > 0 && H5Sget_simple_extent_npoints(space.get()) == 1) {
            char* text = nullptr;
            if (H5Aread(attribute.get(), type.get(), &text) >= 0) {
                const auto changed = rules_.rewrite(path, 0, text == nullptr ? "" : text);
                const char* const written = changed ? changed->c_str() : text;
                done = copy && H5Awrite(copy.get(), type.get(), &written) >= 0;
                H5free_memory(text);
            }
        } else if (H5Tdetect_class(type.get(), H5T_VLEN) <= 0 && H5Tis_variable_str(type.get()) <= 0) {
            std::vector<std::byte> values(
                H5Tget_size(type.get()) *
                static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.get())));
            done = H5Aread(attribute.get(), type.get(), values.data()) >= 0 && copy &&
                   H5Awrite(copy.get(), type.get(), values.data()) >= 0;
        }
        if (!done) {
            fail(path, "the attribute cannot be copied");
        }
    }

    /// Whether another path to the same data set has been copied already; if so, links the copy to it.
    bool linked(hid_t source, const std::string& path) {
        H5O_info_t info;
        if (H5Oget_info(source, &info) < 0 || info.rc < 2) {
            return false;
        }
        const auto [at, added] = copied_.emplace(info.addr, path);
        if (added) {
            return false;
        }
        if (H5Lcreate_hard(to_.id(), at->second.c_str(), to_.id(), path.c_str(), H5P_DEFAULT, H5P_DEFAULT) <
            0) {
            fail(path, "cannot link it in the copy");
        }
        return true;
    }

    void copy_data_set(const std::string& path) {
        const Handle source(H5Dopen2(from_.id(), path.c_str(), H5P_DEFAULT), H5Dclose);
        if (!source) {
            fail(path, "the data set cannot be opened");
        }
        if (linked(source.get(), path)) {
            return;
        }
        Handle type(H5Dget_type(source.get()), H5Tclose);
        const Handle space(H5Dget_space(source.get()), H5Sclose);
        const auto points =
            static_cast<std::size_t>(std::max<hssize_t>(H5Sget_simple_extent_npoints(space.get()), 0));
        const bool text = H5Tget_class(type.get()) == H5T_STRING && H5Tis_variable_str(type.get()) <= 0;
        const auto changed =
            text ? rewritten(source.get(), type.get(), path, points) : std::vector<std::string>{};
        for (const std::string& one : changed) {
            if (one.size() > H5Tget_size(type.get())) {
                type = fixed_text_type(one.size());
            }
        }
        const Handle creation(H5Dget_create_plist(source.get()), H5Pclose);
        H5Pset_obj_track_times(creation.get(), false);
        const Handle copy(H5Dcreate2(to_.id(), path.c_str(), type.get(), space.get(), H5P_DEFAULT,
                                     creation.get(), H5P_DEFAULT),
                          H5Dclose);
        if (!copy) {
            fail(path, "cannot create the data set in the copy");
        }
        if (!changed.empty()) {
            write_texts(copy.get(), type.get(), path, changed);
        } else if (points > 0 && H5Pget_layout(creation.get()) == H5D_CHUNKED) {
            copy_chunks(source.get(), copy.get(), creation.get(), path);
        } else if (points > 0) {
            copy_values(source.get(), copy.get(), type.get(), path, points);
        }
        const Group attributes(Handle(H5Dopen2(from_.id(), path.c_str(), H5P_DEFAULT), H5Dclose),
                               from_.at(path));
        for (const std::string& name : attributes.attributes()) {
            copy_attribute(source.get(), copy.get(), name, below(path, name));
        }
    }

    /// The rewritten texts; empty when none of them changes.
    std::vector<std::string> rewritten(hid_t source, hid_t type, const std::string& path,
                                       std::size_t rows) const {
        const std::size_t width = H5Tget_size(type);
        if (rows > max_read_bytes / width) {
            fail(path, "the data set claims too many rows");
        }
        std::vector<char> bytes(rows * width);
        if (rows > 0 && H5Dread(source, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0) {
            fail(path, "it cannot be read");
        }
        bool changes = false;
        std::vector<std::string> texts(rows);
        for (std::size_t row = 0; row < rows; ++row) {
            const char* const at = bytes.data() + row * width;
            const std::string_view was(at, ::strnlen(at, width));
            const auto changed = rules_.rewrite(path, row, was);
            changes = changes || changed;
            texts[row] = changed.value_or(std::string(was));
        }
        return changes ? texts : std::vector<std::string>{};
    }

    void write_texts(hid_t copy, hid_t type, const std::string& path,
                     const std::vector<std::string>& texts) const {
        const std::size_t width = H5Tget_size(type);
        std::vector<char> bytes(texts.size() * width);
        for (std::size_t row = 0; row < texts.size(); ++row) {
            std::copy_n(texts[row].data(), texts[row].size(), bytes.data() + row * width);
        }
        if (H5Dwrite(copy, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0) {
            fail(path, "it cannot be written into the copy");
        }
    }

    void copy_chunks(hid_t source, hid_t copy, hid_t creation, const std::string& path) {
        const Handle space(H5Dget_space(source), H5Sclose);
        const auto rank = static_cast<std::size_t>(H5Sget_simple_extent_ndims(space.get()));
        std::vector<hsize_t> extent(rank), chunk(rank), offset(rank, 0);
        H5Sget_simple_extent_dims(space.get(), extent.data(), nullptr);
        H5Pget_chunk(creation, static_cast<int>(rank), chunk.data());
        std::vector<std::byte> bytes;
        for (std::size_t axis = 0; axis < rank;) {
            hsize_t size = 0;
            if (H5Dget_chunk_storage_size(source, offset.data(), &size) < 0 || size > max_read_bytes) {
                fail(path, "a chunk cannot be found");
            }
            if (size > 0) {
                std::uint32_t filters = 0;
                bytes.resize(size);
                if (H5Dread_chunk(source, H5P_DEFAULT, offset.data(), &filters, bytes.data()) < 0 ||
                    H5Dwrite_chunk(copy, H5P_DEFAULT, filters, offset.data(), size, bytes.data()) < 0) {
                    fail(path, "a chunk cannot be copied");
                }
            }
            // Next chunk: advance the first axis that has chunks left and reset the axes before it.
            for (axis = 0; axis < rank; ++axis) {
                offset[axis] += chunk[axis];
                if (offset[axis] < extent[axis]) {
                    break;
                }
                offset[axis] = 0;
            }
        }
    }

    void copy_values(hid_t source, hid_t copy, hid_t type, const std::string& path, std::size_t count) {
        if (count > max_read_bytes / H5Tget_size(type)) {
            fail(path, "the data set claims too many rows");
        }
        std::vector<std::byte> values(count * H5Tget_size(type));
        if (H5Dread(source, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0 ||
            H5Dwrite(copy, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
            fail(path, "it cannot be copied");
        }
    }

    const Group &from_, &to_;
    const CopyRules& rules_;
    std::map<haddr_t, std::string> copied_;
};

}  // namespace

void copy_members(const Group& from, const Group& to, const CopyRules& rules) {
    Copier(from, to, rules).copy_group("");
}

}  // namespace eti::hdf5
